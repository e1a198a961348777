#include "core/scene/history.h"

namespace rayuela {

SceneHistory::SceneHistory(std::shared_ptr<const Scene> scene) : current_(std::move(scene)) {}

void SceneHistory::push(std::shared_ptr<const Scene> next, std::string label, std::uint64_t gesture) {
    const bool continues = gesture != 0 && gesture == gesture_ && !undo_.empty();
    if (!continues) undo_.push_back({current_, std::move(label)});
    redo_.clear();
    gesture_ = gesture;
    current_ = std::move(next);
}

bool SceneHistory::undo() {
    if (undo_.empty()) return false;
    redo_.push_back({current_, undo_.back().label});
    current_ = undo_.back().scene;
    undo_.pop_back();
    gesture_ = 0;
    return true;
}

bool SceneHistory::redo() {
    if (redo_.empty()) return false;
    undo_.push_back({current_, redo_.back().label});
    current_ = redo_.back().scene;
    redo_.pop_back();
    gesture_ = 0;
    return true;
}

}  // namespace rayuela
