#pragma once

#include "core/scene/scene.h"
#include "core/scene/settings_fields.h"

#include <array>
#include <bit>
#include <cmath>
#include <random>

namespace rayuela::testing {

using Rng = std::mt19937;

/// Any float of the field's range: small, large, odd in its last bits.
inline float random_float(Rng& rng, const Field& field) {
    for (;;) {
        const float value =
            std::bernoulli_distribution(0.5)(rng)
                ? std::bit_cast<float>(std::uniform_int_distribution<std::uint32_t>()(rng))
                : std::uniform_real_distribution<float>(std::max(field.min, -100.0f), std::min(field.max, 100.0f))(rng);
        // Extremes would overflow in bounds and products, which is not what these tests are about.
        if (!(std::abs(value) > 1e-12f && std::abs(value) < 1e12f)) continue;
        if (value >= field.min && value <= field.max && !(field.min_excluded && value == field.min)) return value;
    }
}

inline void randomize(Rng& rng, float& value, const Field& field) {
    value = random_float(rng, field);
}
inline void randomize(Rng& rng, bool& value, const Field&) {
    value = std::bernoulli_distribution(0.5)(rng);
}
inline void randomize(Rng& rng, Vec3& value, const Field& field) {
    for (int axis = 0; axis < 3; ++axis) value[axis] = random_float(rng, field);
}
inline void randomize(Rng& rng, std::array<Vec3, 3>& value, const Field& field) {
    for (Vec3& vertex : value) randomize(rng, vertex, field);
}
inline void randomize(Rng& rng, ColorValue& value, const Field& field) {
    randomize(rng, value.value, field);
}
inline void randomize(Rng& rng, FloatValue& value, const Field& field) {
    randomize(rng, value.value, field);
}
inline void randomize(Rng&, std::string&, const Field&) {}

template <typename T>
void randomize_fields(Rng& rng, T& value) {
    T::visit_fields(value, [&](auto& member, const Field& field) { randomize(rng, member, field); });
}

inline void repair(Box& box) {
    const Vec3 a = box.min, b = box.max;
    box = {glm::min(a, b), glm::max(a, b)};
}
template <typename T>
void repair(T&) {}

template <typename T>
T random_value(Rng& rng) {
    T value;
    randomize_fields(rng, value);
    repair(value);
    return value;
}

/// Calls visit with a random value of every alternative.
template <typename Variant, typename Visit, std::size_t... I>
void for_each_random(Rng& rng, const Visit& visit, std::index_sequence<I...>) {
    (visit(Variant(random_value<std::variant_alternative_t<I, Variant>>(rng))), ...);
}
template <typename Variant, typename Visit>
void for_each_random(Rng& rng, const Visit& visit) {
    for_each_random<Variant>(rng, visit, std::make_index_sequence<std::variant_size_v<Variant>>());
}

/// One random value of a random alternative.
template <typename Variant>
Variant random_variant(Rng& rng) {
    std::vector<Variant> all;
    for_each_random<Variant>(rng, [&](const Variant& value) { all.push_back(value); });
    return all[std::uniform_int_distribution<std::size_t>(0, all.size() - 1)(rng)];
}

inline Transform random_transform(Rng& rng, const Shape& shape) {
    std::normal_distribution<float> normal;
    Transform transform;
    const auto vec = [&] { return Vec3(normal(rng), normal(rng), normal(rng)); };
    switch (std::uniform_int_distribution(0, 3)(rng)) {
        case 0:
            return transform;
        case 1:
            if (std::holds_alternative<Plane>(shape)) return transform;
            transform.matrix = Mat4(1);
            for (int column = 0; column < 4; ++column) (*transform.matrix)[column] += 0.1f * glm::vec4(vec(), 0);
            return transform;
        default:
            transform.translate = vec();
            transform.rotate = glm::normalize(Quat(normal(rng), normal(rng), normal(rng), normal(rng)));
            if (!std::holds_alternative<Plane>(shape)) transform.scale = Vec3(1) + 0.3f * glm::abs(vec());
            return transform;
    }
}

}  // namespace rayuela::testing
