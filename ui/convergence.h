#pragma once

#include "core/render/frame.h"

#include <vector>

namespace rayuela {

/// The estimated error of an image at growing numbers of samples: what the Statistics panel plots. Points are spaced in
/// proportion, so that a night of rendering is a few hundred of them.
class ConvergenceHistory {
public:
    /// Takes the frame's numbers where they add something; starts anew where accumulation has.
    void add(const RenderStatistics& statistics);

    bool empty() const { return samples.empty(); }

    std::vector<double> samples;  ///< Samples a pixel, rising.
    std::vector<double> seconds;
    std::vector<double> error;  ///< relMSE, > 0.

private:
    std::uint64_t restarts_ = 0;
};

}  // namespace rayuela
