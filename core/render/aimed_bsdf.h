#pragma once

#include "core/lights/targets.h"
#include "core/materials/bsdf.h"
#include "core/render/interaction.h"

#include <optional>

namespace rayuela {

/// The Bsdf of an interaction, half of whose directions may be drawn towards targets instead: for light that arrives by
/// way of few and small things. Densities are those of the mixture.
class AimedBsdf {
public:
    /// `targets` may be null: then this is the Bsdf and nothing else. So it is where none of them is above the surface,
    /// and on materials that let light pass.
    AimedBsdf(const Interaction& at, const Targets* targets) : at_(at) {
        if (!targets || at.material.transmits || !at.material.smooth) return;
        const LightReceiver receiver = at.receiver();
        view_.emplace(*targets, receiver.p, receiver.n);
        if (view_->extent() == 0) view_.reset();
    }

    /// Whether there are targets.
    bool aims() const { return view_.has_value(); }
    /// As Bsdf::evaluate; `w` is the world direction of `wi`.
    BsdfValue evaluate(const Vec3& wi, const Vec3& w) const {
        BsdfValue f = at_.bsdf().evaluate(at_.wo_local, wi);
        if (view_) f.pdf = (1 - kAimed) * f.pdf + kAimed * view_->pdf(w);
        return f;
    }

    /// As Bsdf::sample.
    std::optional<BsdfSample> sample(float u_lobe, const Vec2& u) const {
        return view_ ? sample_mixture(u_lobe, u) : at_.bsdf().sample(at_.wo_local, u_lobe, u);
    }

private:
    std::optional<BsdfSample> sample_mixture(float u_lobe, const Vec2& u) const {
        std::optional<BsdfSample> s =
            u_lobe < kAimed ? scattered(at_.frame.to_local(view_->sample(u_lobe / kAimed, u)), Color(0), 0)
                            : at_.bsdf().sample(at_.wo_local, (u_lobe - kAimed) / (1 - kAimed), u);
        if (!s) return s;
        if (s->specular) {
            s->pdf *= 1 - kAimed;
            s->weight /= 1 - kAimed;
            return s;
        }
        const BsdfValue f = evaluate(s->wi, at_.frame.to_world(s->wi));
        s->pdf = f.pdf;
        s->weight = f.value / f.pdf;
        if (!(s->pdf > 0 && s->pdf < kInfinity) || is_black(s->weight)) s.reset();
        return s;
    }

    static constexpr float kAimed = 0.5f;

    const Interaction& at_;
    std::optional<TargetView> view_;
};

}  // namespace rayuela
