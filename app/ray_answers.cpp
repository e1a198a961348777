#include "app/ray_answers.h"

#include <algorithm>
#include <cmath>

namespace rayuela {

void RayAnswers::trace(const Accelerator& structure, std::span<const Ray> rays, bool any_hit, std::size_t begin,
                       std::size_t end) {
    for (std::size_t i = begin; i < end; i += kBatch) {
        const std::size_t n = std::min(kBatch, end - i);
        if (any_hit) {
            structure.occluded(rays.subspan(i, n), std::span(blocked).subspan(i, n));
        } else {
            structure.intersect(rays.subspan(i, n), std::span(hits).subspan(i, n));
        }
    }
}

bool RayAnswers::same(std::size_t i, const RayAnswers& others, std::size_t k, bool any_hit) const {
    if (any_hit) return blocked[i] == others.blocked[k];
    return hits[i].t == others.hits[k].t && hits[i].primitive == others.hits[k].primitive;
}

double disagreement(const RayAnswers& ours, const EmbreeQuery& theirs, bool any_hit) {
    const std::size_t rays = ours.hits.size();
    std::size_t different = 0;
    for (std::size_t i = 0; i < rays; ++i) {
        if (ours.primitive(i, any_hit) == theirs.primitive(i)) continue;
        const bool same_place = !any_hit && ours.hits[i].valid() && theirs.primitive(i) != kNone &&
                                std::fabs(ours.hits[i].t - theirs.t(i)) <= 1e-5f * theirs.t(i);
        different += same_place ? 0 : 1;
    }
    return 1e6 * static_cast<double>(different) / static_cast<double>(rays);
}

}  // namespace rayuela
