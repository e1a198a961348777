#pragma once

#include "core/scene/scene.h"

#include <memory>
#include <string>
#include <vector>

namespace rayuela {

/// Undo and redo as snapshots. Scenes share their heavy data, so a snapshot is small.
class SceneHistory {
public:
    explicit SceneHistory(std::shared_ptr<const Scene> scene);

    const std::shared_ptr<const Scene>& current() const { return current_; }
    /// Makes `next` current. Pushes with the same non-zero `gesture` as the last push replace it: a drag is one step.
    void push(std::shared_ptr<const Scene> next, std::string label, std::uint64_t gesture = 0);
    /// False, and nothing happens, where there is nothing to undo or redo.
    bool undo();
    bool redo();
    bool can_undo() const { return !undo_.empty(); }
    bool can_redo() const { return !redo_.empty(); }
    /// What undo (redo) would take back (bring back); empty where there is nothing.
    std::string undo_label() const { return undo_.empty() ? "" : undo_.back().label; }
    std::string redo_label() const { return redo_.empty() ? "" : redo_.back().label; }

private:
    struct Step {
        std::shared_ptr<const Scene> scene;
        std::string label;
    };
    std::shared_ptr<const Scene> current_;
    std::vector<Step> undo_, redo_;
    std::uint64_t gesture_ = 0;
};

}  // namespace rayuela
