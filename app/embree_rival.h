#pragma once

#include "core/math/ray.h"
#include "core/shapes/mesh.h"

#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace rayuela {

enum class EmbreeMode { single, packet16, stream };
std::string_view name_of(EmbreeMode mode);

/// Rays in Embree's layout and its answers in the same place. Conversion is kept out of what is timed, as a renderer on top
/// of Embree would keep its rays in that layout.
class EmbreeQuery {
public:
    EmbreeQuery(std::span<const Ray> rays, bool any_hit, EmbreeMode mode, bool coherent);
    ~EmbreeQuery();
    EmbreeQuery(EmbreeQuery&&) noexcept;

    /// Forgets the answers.
    void reset();
    /// The triangle that ray i hits first, or kNone; of an any-hit query 0 where it is blocked.
    std::uint32_t primitive(std::size_t i) const;
    float t(std::size_t i) const;
    EmbreeMode mode() const;

    struct Rays;
    Rays& rays() const { return *rays_; }

private:
    std::unique_ptr<Rays> rays_;
};

/// Embree over one mesh: a rival to time and a second opinion.
class EmbreeRival {
public:
    /// Null where Embree 3 was not there at build time. Builds with so many threads; 0: with all.
    static std::unique_ptr<const EmbreeRival> build(const TriangleMesh& mesh, bool robust, int threads = 0);
    ~EmbreeRival();

    /// Traces rays [begin, end) of the query; both are multiples of 16 or the very end.
    void trace(EmbreeQuery& query, std::size_t begin, std::size_t end) const;
    double build_cpu_seconds() const { return build_cpu_seconds_; }
    double build_wall_seconds() const { return build_wall_seconds_; }
    /// Of what was built, beside the vertices and the triangles themselves.
    std::uint64_t memory_bytes() const { return memory_bytes_; }

private:
    struct Scene;
    EmbreeRival();
    std::unique_ptr<Scene> scene_;
    double build_cpu_seconds_ = 0, build_wall_seconds_ = 0;
    std::uint64_t memory_bytes_ = 0;
};

}  // namespace rayuela
