#pragma once

#include "core/materials/bsdf.h"
#include "core/math/sampler.h"

#include <fmt/format.h>

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace rayuela::test {

struct MaterialCase {
    std::string name;
    Material material;
};

/// Sets a field to the share t of its usual range, from a number in [0, 1).
struct SetField {
    float t;

    static float in_range(const Field& field, float t) {
        const bool soft = field.soft_min < field.soft_max;
        const float lo = soft ? std::max(field.min, field.soft_min) : field.min;
        const float hi = soft ? std::min(field.max, field.soft_max) : field.max;
        return lo + t * (hi - lo);
    }
    bool operator()(float& x, const Field& field) const {
        x = in_range(field, t);
        return true;
    }
    bool operator()(FloatValue& x, const Field& field) const { return (*this)(x.value, field); }
    bool operator()(bool& x, const Field&) const {
        x = t >= 0.5f;
        return true;
    }
    bool operator()(ColorValue& x, const Field& field) const {
        x.value = Color(in_range(field, t), in_range(field, 1 - t), in_range(field, 0.5f * t));
        return true;
    }
};

/// Defaults of each material of the list; each of its fields over its range; and all fields at random.
inline std::vector<MaterialCase> material_cases() {
    std::vector<MaterialCase> cases;
    const auto add = [&]<typename M>(std::type_identity<M>) {
        const std::string type(M::kType);
        cases.push_back({type, M{}});
        int fields = 0;
        M counted;
        M::visit_fields(counted, [&](auto&, const Field&) { ++fields; });
        for (int chosen = 0; chosen < fields; ++chosen) {
            for (const float t : {0.0f, 0.001f, 0.03f, 0.1f, 0.5f, 1.0f}) {
                M material;
                int index = 0;
                std::string key;
                M::visit_fields(material, [&](auto& member, const Field& field) {
                    if (index++ != chosen) return;
                    SetField{t}(member, field);
                    key = field.key;
                });
                if (!(material == M{})) cases.push_back({fmt::format("{} {} {}", type, key, t), material});
            }
        }
        for (std::uint32_t i = 0; i < 8; ++i) {
            const Sampler sampler(SamplerKind::independent, 1, i, static_cast<std::uint32_t>(cases.size()));
            M material;
            std::uint32_t index = 0;
            M::visit_fields(
                material, [&](auto& member, const Field& field) { SetField{sampler.get_1d(index++)}(member, field); });
            cases.push_back({fmt::format("{} random {}", type, i), material});
        }
    };
    [&]<typename... M>(std::type_identity<std::variant<M...>>) {
        (add(std::type_identity<M>{}), ...);
    }(std::type_identity<Material>{});
    return cases;
}

}  // namespace rayuela::test
