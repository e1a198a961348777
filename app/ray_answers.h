#pragma once

#include "app/embree_rival.h"
#include "core/accel/accelerator.h"

namespace rayuela {

/// Answers of one structure to one set of rays.
struct RayAnswers {
    std::vector<Hit> hits;
    std::vector<std::uint8_t> blocked;

    static constexpr std::size_t kBatch = 4096;  ///< As many as a tile of the renderer carries.

    RayAnswers(std::size_t rays) : hits(rays), blocked(rays) {}
    /// Answers rays [begin, end) of those in batches.
    void trace(const Accelerator& structure, std::span<const Ray> rays, bool any_hit, std::size_t begin,
               std::size_t end);
    /// What EmbreeQuery::primitive says.
    std::uint32_t primitive(std::size_t i, bool any_hit) const {
        return any_hit ? (blocked[i] ? 0 : kNone) : hits[i].primitive;
    }
    /// Whether ray i found what ray k of the others found, to the last bit.
    bool same(std::size_t i, const RayAnswers& others, std::size_t k, bool any_hit) const;
};

/// Rays in a million on which they name different triangles. At a shared edge both are right: there t decides.
double disagreement(const RayAnswers& ours, const EmbreeQuery& theirs, bool any_hit);

}  // namespace rayuela
