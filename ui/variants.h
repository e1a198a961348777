#pragma once

#include "core/math/field.h"

#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

namespace rayuela {

/// Calls f.operator()<T>() for each alternative T of a list such as Shape, Material or Environment.
template <typename Variant, typename F>
void for_each_type(F&& f) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
        (f.template operator()<std::variant_alternative_t<I, Variant>>(), ...);
    }
    (std::make_index_sequence<std::variant_size_v<Variant>>());
}

template <typename Variant>
std::string_view type_label(const Variant& value) {
    return std::visit([]<typename T>(const T&) { return T::kLabel; }, value);
}

/// Whether the struct names a file, without which it is not complete.
template <typename T>
bool needs_file() {
    bool found = false;
    const T value{};
    T::visit_fields(value, [&](const auto&, const Field& field) { found |= field.role == FieldRole::file; });
    return found;
}

/// A new T with the members that `value` has under the same key and type: changing a kind keeps what it can.
template <typename T, typename Variant>
T converted(const Variant& value) {
    T result{};
    std::visit(
        [&]<typename S>(const S& source) {
            T::visit_fields(result, [&]<typename M>(M& member, const Field& field) {
                S::visit_fields(source, [&]<typename N>(const N& other, const Field& other_field) {
                    if constexpr (std::is_same_v<M, N>) {
                        if (field.key == other_field.key) member = other;
                    }
                });
            });
        },
        value);
    return result;
}

}  // namespace rayuela
