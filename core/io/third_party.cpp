// The implementations of single-header libraries, on systems that do not package them as libraries.
#ifdef RAYUELA_STB_HEADER_ONLY
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb_image.h>
#include <stb_image_write.h>
#endif

#ifdef RAYUELA_TINYGLTF_HEADER_ONLY
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <tiny_gltf.h>
#endif

#ifdef RAYUELA_TINYOBJ_HEADER_ONLY
#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>
#endif
