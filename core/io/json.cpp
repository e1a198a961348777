#include "core/io/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <unordered_set>

namespace rayuela {

const Json* Json::find(std::string_view key) const {
    const auto* object = get<Object>();
    if (!object) return nullptr;
    const auto found = std::ranges::find(*object, key, &Member::first);
    return found == object->end() ? nullptr : &found->second;
}

std::string_view Json::type_name() const {
    constexpr std::string_view kNames[] = {"null",   "true or false", "a number", "a number",
                                           "a text", "an array",      "an object"};
    return kNames[value.index()];
}

int json_depth(std::string_view text) {
    int depth = 0, deepest = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string) {
            if (c == '\\') ++i;
            if (c == '"') in_string = false;
        } else if (c == '"') {
            in_string = true;
        } else if (c == '[' || c == '{') {
            deepest = std::max(deepest, ++depth);
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
    return deepest;
}

namespace {

/// "[json.exception.parse_error.101] parse error at line 1, column 2: cause" -> "cause".
std::string cause_of(const nlohmann::json::exception& exception) {
    std::string_view cause = exception.what();
    cause.remove_prefix(std::min(cause.find("] ") + 2, cause.size()));
    if (cause.starts_with("parse error")) cause.remove_prefix(std::min(cause.find(": ") + 2, cause.size()));
    return std::string(cause);
}

/// Receives the parser's events and builds the value.
class Builder {
public:
    Builder(std::string_view text, const std::string& name) : text_(text), name_(name) {}

    bool null() { return add(Json()); }
    bool boolean(bool v) { return add(Json(v)); }
    bool number_integer(std::int64_t v) { return add(Json(static_cast<double>(v))); }
    bool number_unsigned(std::uint64_t v) { return add(Json(static_cast<double>(v))); }
    bool number_float(double v, const std::string&) { return add(Json(v)); }
    bool string(std::string& v) { return add(Json(std::move(v))); }
    bool binary(nlohmann::json::binary_t&) { return false; }
    bool start_object(std::size_t) { return open(Json(Json::Object())); }
    bool end_object() { return close(); }
    bool start_array(std::size_t) { return open(Json(Json::Array())); }
    bool end_array() { return close(); }

    bool key(std::string& key) {
        Level& level = levels_.back();
        if (!level.keys.insert(key).second) problem(path() + (path().empty() ? "" : ".") + key, "is given twice");
        level.key = key;
        return true;
    }

    bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception& exception) {
        const std::string_view before = text_.substr(0, position > 0 ? position - 1 : 0);
        const std::size_t line_start = before.rfind('\n') + 1;
        problem(fmt::format("line {}, column {}", std::ranges::count(before, '\n') + 1, before.size() - line_start + 1),
                cause_of(exception));
        return false;
    }

    Json root;
    Problems problems;

private:
    struct Level {
        Json container;
        std::string key;
        std::unordered_set<std::string> keys;
    };

    bool open(Json container) {
        if (levels_.size() >= static_cast<std::size_t>(kMaxJsonDepth)) {
            problem(path(), "is nested too deeply");
            return false;
        }
        levels_.push_back({std::move(container), {}, {}});
        return true;
    }

    bool close() {
        Json done = std::move(levels_.back().container);
        levels_.pop_back();
        return add(std::move(done));
    }

    bool add(Json value) {
        if (levels_.empty()) {
            root = std::move(value);
            return true;
        }
        Level& level = levels_.back();
        if (auto* array = std::get_if<Json::Array>(&level.container.value)) {
            array->push_back(std::move(value));
        } else {
            std::get<Json::Object>(level.container.value).emplace_back(std::move(level.key), std::move(value));
        }
        return true;
    }

    std::string path() const {
        std::string result;
        for (std::size_t i = 0; i + 1 < levels_.size(); ++i) {
            const Level& level = levels_[i];
            if (const auto* array = level.container.get<Json::Array>()) {
                result += fmt::format("[{}]", array->size());
            } else {
                result += (result.empty() ? "" : ".") + level.key;
            }
        }
        return result;
    }

    void problem(std::string place, std::string cause) {
        problems.push_back({name_, std::move(place), std::move(cause)});
    }

    std::string_view text_;
    const std::string& name_;
    std::vector<Level> levels_;
};

constexpr std::size_t kLineWidth = 140;

std::string quoted(const std::string& text) {
    return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

template <typename Number>
std::string number_text(Number number) {
    if (number == 0 && std::signbit(number)) return "-0.0";  // "-0" would be read as an integer.
    return fmt::format("{}", number);
}

std::string on_one_line(const Json& json) {
    struct Visitor {
        std::string operator()(std::nullptr_t) const { return "null"; }
        std::string operator()(bool v) const { return v ? "true" : "false"; }
        std::string operator()(double v) const { return number_text(v); }
        std::string operator()(float v) const { return number_text(v); }
        std::string operator()(const std::string& v) const { return quoted(v); }
        std::string operator()(const Json::Array& array) const {
            std::string text = "[";
            for (const Json& item : array) text += (text.size() > 1 ? ", " : "") + on_one_line(item);
            return text + "]";
        }
        std::string operator()(const Json::Object& object) const {
            std::string text = "{";
            for (const auto& [key, item] : object)
                text += (text.size() > 1 ? ", " : "") + quoted(key) + ": " + on_one_line(item);
            return text + "}";
        }
    };
    return std::visit(Visitor{}, json.value);
}

/// `used` characters of the line are taken already.
std::string pretty(const Json& json, std::size_t indent, std::size_t used) {
    std::string line = on_one_line(json);
    if (indent > 0 && used + line.size() <= kLineWidth) return line;
    const std::string blanks(indent + 2, ' ');
    std::string text;
    if (const auto* array = json.get<Json::Array>()) {
        for (const Json& item : *array)
            text += (text.empty() ? "\n" : ",\n") + blanks + pretty(item, indent + 2, indent + 2);
        return "[" + text + "\n" + std::string(indent, ' ') + "]";
    }
    if (const auto* object = json.get<Json::Object>()) {
        for (const auto& [key, item] : *object) {
            const std::string lead = blanks + quoted(key) + ": ";
            text += (text.empty() ? "\n" : ",\n") + lead + pretty(item, indent + 2, lead.size());
        }
        return "{" + text + "\n" + std::string(indent, ' ') + "}";
    }
    return line;
}

}  // namespace

Result<Json> parse_json(std::string_view text, const std::string& name) {
    Builder builder(text, name);
    const bool ok =
        nlohmann::json::sax_parse(text.begin(), text.end(), &builder, nlohmann::json::input_format_t::json, true, true);
    if (!ok && builder.problems.empty()) builder.problems.push_back({name, "", "is no valid JSON"});
    if (!builder.problems.empty()) return tl::unexpected(std::move(builder.problems));
    return std::move(builder.root);
}

std::string to_text(const Json& json) {
    return pretty(json, 0, 0) + "\n";
}

}  // namespace rayuela
