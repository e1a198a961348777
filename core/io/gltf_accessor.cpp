#include "core/io/gltf_internal.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <limits>

namespace rayuela::gltf_internal {

namespace {

/// Elements without bytes behind them (all zero, or sparse) are limited more strictly than those the file contains.
constexpr std::size_t kMaxImpliedElements = std::size_t{1} << 24;

template <typename T>
double load(const unsigned char* bytes, bool normalized) {
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    if (!normalized || std::is_floating_point_v<T>) return static_cast<double>(value);
    return std::max(static_cast<double>(value) / static_cast<double>(std::numeric_limits<T>::max()), -1.0);
}

double load(int type, const unsigned char* bytes, bool normalized) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return load<std::int8_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return load<std::uint8_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return load<std::int16_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return load<std::uint16_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return load<std::uint32_t>(bytes, normalized);
        default:
            return load<float>(bytes, normalized);
    }
}

/// Bytes of one component; 0 for those that no vertex or index may have.
std::size_t component_size(int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return 4;
        default:
            return 0;
    }
}

std::string place_of(int accessor) {
    return fmt::format("accessors[{}]", accessor);
}

/// The `count` elements of `size` bytes that begin at `offset` of a buffer view, `stride` bytes apart (0: packed).
struct Elements {
    const unsigned char* first;
    std::size_t stride;
};

Expected<Elements> elements(const tinygltf::Model& model, int view, std::size_t offset, std::size_t count,
                            std::size_t size, bool strided) {
    const auto bytes = view_bytes(model, view);
    if (!bytes) return tl::unexpected(bytes.error());
    const std::size_t byte_stride = model.bufferViews[static_cast<std::size_t>(view)].byteStride;
    const std::size_t stride = strided && byte_stride ? byte_stride : size;
    if (count == 0) return Elements{bytes->data(), stride};
    // Divided instead of multiplied, because count * stride may overflow.
    const bool fits = offset <= bytes->size() && size <= bytes->size() - offset &&
                      (count - 1) <= (bytes->size() - offset - size) / stride;
    if (!fits) {
        return tl::unexpected(
            fmt::format("{} elements of {} bytes from byte {} on do not fit bufferViews[{}] of {} bytes", count, stride,
                        offset, view, bytes->size()));
    }
    return Elements{bytes->data() + offset, stride};
}

/// Calls set(element, component, value) for every component of the accessor, sparse replacements last.
template <typename Set>
Expected<void> read_components(const tinygltf::Model& model, int index, int components, const Set& set) {
    const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
    const std::size_t component = component_size(accessor.componentType);
    const std::size_t size = component * static_cast<std::size_t>(components);
    const auto copy = [&](const Elements& from, std::size_t count, const auto& target) {
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t c = 0; c < static_cast<std::size_t>(components); ++c) {
                set(target(i), c,
                    load(accessor.componentType, from.first + i * from.stride + c * component, accessor.normalized));
            }
        }
    };
    if (accessor.bufferView >= 0) {
        const auto from = elements(model, accessor.bufferView, accessor.byteOffset, accessor.count, size, true);
        if (!from) return tl::unexpected(from.error());
        copy(*from, accessor.count, [](std::size_t i) { return i; });
    }
    if (!accessor.sparse.isSparse) return {};

    const auto& sparse = accessor.sparse;
    const std::size_t index_size = component_size(sparse.indices.componentType);
    const bool is_integer = sparse.indices.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT;
    if (sparse.count < 0 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0 || !index_size ||
        !is_integer) {
        return tl::unexpected<std::string>("has a damaged sparse part");
    }
    const auto count = static_cast<std::size_t>(sparse.count);
    const auto indices = elements(model, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset),
                                  count, index_size, false);
    if (!indices) return tl::unexpected(indices.error());
    const auto values = elements(model, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset),
                                 count, size, false);
    if (!values) return tl::unexpected(values.error());
    std::vector<std::size_t> targets(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double target = load(sparse.indices.componentType, indices->first + i * indices->stride, false);
        if (!(target >= 0) || target >= static_cast<double>(accessor.count)) {
            return tl::unexpected(
                fmt::format("its sparse index {} is out of range, there are {}", target, accessor.count));
        }
        targets[i] = static_cast<std::size_t>(target);
    }
    copy(*values, count, [&](std::size_t i) { return targets[i]; });
    return {};
}

/// The accessor, if it exists and has the type and a believable size.
Expected<const tinygltf::Accessor*> find_accessor(const tinygltf::Model& model, int index, int components) {
    if (index < 0 || static_cast<std::size_t>(index) >= model.accessors.size()) {
        return tl::unexpected(place_of(index) + " does not exist");
    }
    const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
    const int type = components == 1 ? TINYGLTF_TYPE_SCALAR : components == 2 ? TINYGLTF_TYPE_VEC2 : TINYGLTF_TYPE_VEC3;
    if (accessor.type != type) return tl::unexpected(place_of(index) + " has the wrong type");
    if (!component_size(accessor.componentType))
        return tl::unexpected(place_of(index) + " has an unknown component type");
    if (accessor.bufferView < 0 && accessor.count > kMaxImpliedElements) {
        return tl::unexpected(place_of(index) + " has too many elements");
    }
    if (accessor.bufferView >= 0) {
        // Before anything is allocated for `count` elements.
        const std::size_t size = component_size(accessor.componentType) * static_cast<std::size_t>(components);
        const auto bytes = elements(model, accessor.bufferView, accessor.byteOffset, accessor.count, size, true);
        if (!bytes) return tl::unexpected(place_of(index) + ": " + bytes.error());
    }
    return &accessor;
}

}  // namespace

Expected<std::span<const unsigned char>> view_bytes(const tinygltf::Model& model, int index) {
    if (index < 0 || static_cast<std::size_t>(index) >= model.bufferViews.size()) {
        return tl::unexpected(fmt::format("bufferViews[{}] does not exist", index));
    }
    const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(index)];
    if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model.buffers.size()) {
        return tl::unexpected(fmt::format("buffers[{}] does not exist", view.buffer));
    }
    const auto& data = model.buffers[static_cast<std::size_t>(view.buffer)].data;
    if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset) {
        return tl::unexpected(fmt::format("bufferViews[{}] ({} bytes from {} on) reaches beyond its buffer of {} bytes",
                                          index, view.byteLength, view.byteOffset, data.size()));
    }
    return std::span(data.data() + view.byteOffset, view.byteLength);
}

Expected<std::vector<float>> read_floats(const tinygltf::Model& model, int index, int components) {
    const auto accessor = find_accessor(model, index, components);
    if (!accessor) return tl::unexpected(accessor.error());
    std::vector<float> floats((*accessor)->count * static_cast<std::size_t>(components));
    const auto done =
        read_components(model, index, components, [&](std::size_t element, std::size_t component, double value) {
            floats[element * static_cast<std::size_t>(components) + component] = static_cast<float>(value);
        });
    if (!done) return tl::unexpected(place_of(index) + ": " + done.error());
    return floats;
}

Expected<std::vector<std::uint32_t>> read_indices(const tinygltf::Model& model, int index) {
    const auto accessor = find_accessor(model, index, 1);
    if (!accessor) return tl::unexpected(accessor.error());
    const int type = (*accessor)->componentType;
    if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
        type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
        return tl::unexpected(place_of(index) + ": indices must be unsigned integers");
    }
    if ((*accessor)->normalized) return tl::unexpected(place_of(index) + ": indices must not be normalized");
    std::vector<std::uint32_t> indices((*accessor)->count);
    const auto done = read_components(model, index, 1, [&](std::size_t element, std::size_t, double value) {
        indices[element] = static_cast<std::uint32_t>(value);
    });
    if (!done) return tl::unexpected(place_of(index) + ": " + done.error());
    return indices;
}

}  // namespace rayuela::gltf_internal
