#include "core/io/image_formats.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStdIO.h>

#include <array>
#include <exception>
#include <sstream>

namespace rayuela::image_formats {

namespace {

Decoded decode(const std::string& bytes) {
    Imf::StdISStream stream;
    stream.str(bytes);
    Imf::InputFile file(stream);
    const Imath::Box2i window = file.header().dataWindow();
    const long long width = 1LL + window.max.x - window.min.x, height = 1LL + window.max.y - window.min.y;
    Decoded image = image_of_size(width, height);
    if (!image) return image;

    const Imf::ChannelList& channels = file.header().channels();
    const bool grey = !channels.findChannel("R") && channels.findChannel("Y");
    const std::array<const char*, 4> names = grey ? std::array{"Y", "Y", "Y", "A"} : std::array{"R", "G", "B", "A"};
    if (!channels.findChannel(names[0])) return tl::unexpected<std::string>("has no channel R, G, B or Y");
    allocate(*image);
    Imf::FrameBuffer frame;
    for (std::size_t i = 0; i < 4; ++i) {
        const Imf::Channel* channel = channels.findChannel(names[i]);
        if (!channel || (grey && (i == 1 || i == 2))) continue;
        if (channel->xSampling != 1 || channel->ySampling != 1) {
            return tl::unexpected<std::string>("has subsampled channels, which are not read");
        }
        float* base = &image->pixels.front().x + i;
        frame.insert(names[i], Imf::Slice::Make(Imf::FLOAT, base, window, sizeof(Vec4),
                                                sizeof(Vec4) * static_cast<std::size_t>(width)));
    }
    file.setFrameBuffer(frame);
    file.readPixels(window.min.y, window.max.y);
    if (grey) {
        for (Vec4& pixel : image->pixels) pixel.y = pixel.z = pixel.x;
    }
    return image;
}

}  // namespace

Decoded decode_exr(const std::string& bytes) {
    try {
        return decode(bytes);
    } catch (const std::exception& error) {
        return tl::unexpected("cannot be decoded: " + std::string(error.what()));
    }
}

tl::expected<std::string, std::string> encode_exr(const Image& image) {
    try {
        Imf::Header header(image.width, image.height);
        header.compression() = Imf::ZIP_COMPRESSION;
        Imf::FrameBuffer frame;
        const std::array names = {"R", "G", "B"};
        for (std::size_t i = 0; i < names.size(); ++i) {
            header.channels().insert(names[i], Imf::Channel(Imf::FLOAT));
            // OpenEXR's slices are not const, but an output file only reads them.
            char* base = const_cast<char*>(reinterpret_cast<const char*>(image.pixels.data())) + i * sizeof(float);
            frame.insert(names[i], Imf::Slice(Imf::FLOAT, base, sizeof(Vec4),
                                              sizeof(Vec4) * static_cast<std::size_t>(image.width)));
        }
        Imf::StdOSStream stream;
        {
            Imf::OutputFile file(stream, header);
            file.setFrameBuffer(frame);
            file.writePixels(image.height);
        }
        return stream.str();
    } catch (const std::exception& error) {
        return tl::unexpected("EXR encoding failed: " + std::string(error.what()));
    }
}

}  // namespace rayuela::image_formats
