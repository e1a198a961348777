#include "core/io/object_names.h"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

namespace rayuela {

namespace {

/// "Sphere" and "Sphere 12", but not "Sphere a".
bool is_numbered(const ObjectName& object) {
    std::string_view rest = object.name;
    if (!rest.starts_with(object.label)) return false;
    rest.remove_prefix(object.label.size());
    return rest.empty() || (rest.size() > 1 && rest.front() == ' ' &&
                            rest.substr(1).find_first_not_of("0123456789") == std::string_view::npos);
}

}  // namespace

void fill_in_names(std::vector<ObjectName>& objects) {
    std::unordered_set<std::string> taken;
    for (const ObjectName& object : objects) taken.insert(object.name);
    std::unordered_map<std::string_view, int> last;  // So that naming many of a kind takes linear time.
    for (ObjectName& object : objects) {
        if (!object.name.empty()) continue;
        int& number = last[object.label];
        do {
            ++number;
            object.name = object.label;
            if (number > 1) object.name += " " + std::to_string(number);
        } while (!taken.insert(object.name).second);
    }
}

std::vector<bool> names_to_leave_out(const std::vector<ObjectName>& objects) {
    std::vector<bool> left_out(objects.size());
    std::vector<ObjectName> without = objects;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        left_out[i] = is_numbered(objects[i]);
        if (left_out[i]) without[i].name.clear();
    }
    fill_in_names(without);
    const auto same_name = [](const ObjectName& a, const ObjectName& b) { return a.name == b.name; };
    if (!std::ranges::equal(objects, without, same_name)) left_out.assign(objects.size(), false);
    return left_out;
}

}  // namespace rayuela
