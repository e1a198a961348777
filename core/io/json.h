#pragma once

#include "core/math/result.h"

#include <concepts>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace rayuela {

/// A JSON value whose objects keep the order of their members, as a file has them.
class Json {
public:
    using Array = std::vector<Json>;
    using Member = std::pair<std::string, Json>;
    using Object = std::vector<Member>;
    /// Numbers read are doubles; floats are written with the fewest digits that give the same float again.
    using Value = std::variant<std::nullptr_t, bool, double, float, std::string, Array, Object>;

    Json() : value(nullptr) {}
    template <typename T>
    requires std::constructible_from<Value, T> Json(T v) : value(std::move(v)) {}

    template <typename T>
    const T* get() const {
        return std::get_if<T>(&value);
    }
    /// Of an object; null where it has no such member.
    const Json* find(std::string_view key) const;
    /// "a number", "an object"...
    std::string_view type_name() const;

    bool operator==(const Json&) const = default;

    Value value;
};

inline constexpr int kMaxJsonDepth = 512;

/// How deeply arrays and objects are nested; cheap, and right for any text that is JSON.
int json_depth(std::string_view text);

/// Comments are allowed. A syntax error names line and column, a key given twice its JSON path.
Result<Json> parse_json(std::string_view text, const std::string& name);

/// A text for people: what fits a line stands on one line, members are indented by two blanks.
std::string to_text(const Json& json);

}  // namespace rayuela
