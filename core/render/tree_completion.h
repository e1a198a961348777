#pragma once

#include "core/render/render_scene.h"

#include <functional>
#include <thread>

namespace rayuela {

/// Builds the trees that a scene with drafts was meant to have, in a thread of its own.
class TreeCompletion {
public:
    /// Without trees where they could not be built (out of memory).
    using Done = std::function<void(std::shared_ptr<const Accelerator>)>;

    /// `done` is called on that thread, unless the building is broken off.
    TreeCompletion(std::shared_ptr<const RenderScene> scene, int threads, Done done);
    /// Breaks it off.
    ~TreeCompletion();
    TreeCompletion(const TreeCompletion&) = delete;
    TreeCompletion& operator=(const TreeCompletion&) = delete;

    /// Whether the trees are of the kind that `scene` is meant to have; those of meshes that came later will be missing.
    bool suits(const RenderScene& scene) const;
    /// In [0, 1]; may be called on any thread.
    double progress() const;

private:
    void run(int threads, const Done& done);

    const std::shared_ptr<const RenderScene> scene_;
    BuildControl control_;
    std::thread thread_;
};

}  // namespace rayuela
