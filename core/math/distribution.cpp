#include "core/math/distribution.h"

#include "core/math/float_error.h"

#include <algorithm>
#include <cmath>

namespace rayuela {
namespace {

double usable(float weight) {
    return std::isfinite(weight) && weight > 0 ? weight : 0.0;
}

}  // namespace

AliasTable::AliasTable(std::span<const float> weights) {
    double total = 0;
    for (const float weight : weights) total += usable(weight);
    if (total == 0) return;

    const std::size_t n = weights.size();
    slots_.resize(n);
    std::vector<double> share(n);  // of a slot; 1 fills it
    std::vector<std::uint32_t> poor, rich;
    for (std::uint32_t i = 0; i < n; ++i) {
        const double probability = usable(weights[i]) / total;
        share[i] = probability * static_cast<double>(n);
        slots_[i] = {1, i, static_cast<float>(probability)};
        (share[i] < 1 ? poor : rich).push_back(i);
    }
    while (!poor.empty() && !rich.empty()) {
        const std::uint32_t receiver = poor.back(), giver = rich.back();
        poor.pop_back();
        slots_[receiver].threshold = static_cast<float>(share[receiver]);
        slots_[receiver].alias = giver;
        share[giver] -= 1 - share[receiver];
        if (share[giver] < 1) {
            rich.pop_back();
            poor.push_back(giver);
        }
    }
    // What is left is full but for rounding; an index of weight 0 must not be drawn even then.
    const auto heaviest = static_cast<std::uint32_t>(std::ranges::max_element(share) - share.begin());
    for (const std::uint32_t i : poor) {
        if (usable(weights[i]) == 0) slots_[i] = {0, heaviest, 0};
    }
}

AliasTable::Draw AliasTable::draw(float u) const {
    const float scaled = u * static_cast<float>(slots_.size());
    const std::size_t slot = std::min(static_cast<std::size_t>(scaled), slots_.size() - 1);
    const float within = scaled - static_cast<float>(slot);
    const float threshold = slots_[slot].threshold;
    const bool own = within < threshold;
    const std::uint32_t index = own ? static_cast<std::uint32_t>(slot) : slots_[slot].alias;
    const float remainder = own ? within / threshold : (within - threshold) / (1 - threshold);
    return {index, slots_[index].probability, std::min(remainder, 1 - kUnitRoundoff)};
}

Distribution1D::Distribution1D(std::span<const float> weights) {
    for (const float weight : weights) total_ += usable(weight);
    cdf_.reserve(weights.size() + 1);
    cdf_.push_back(0);
    if (total_ == 0) {
        cdf_.resize(weights.size() + 1, 0);
        return;
    }
    double sum = 0;
    for (const float weight : weights) cdf_.push_back(static_cast<float>((sum += usable(weight)) / total_));
}

Distribution1D::Draw Distribution1D::draw(float u) const {
    const auto above = std::upper_bound(cdf_.begin() + 1, cdf_.end() - 1, u);
    const auto cell = static_cast<std::uint32_t>(above - cdf_.begin() - 1);
    const float width = probability(cell);
    return {cell, width, std::clamp((u - cdf_[cell]) / width, 0.0f, 0x1.fffffep-1f)};
}

Distribution2D::Distribution2D(std::span<const float> weights, std::uint32_t columns) {
    std::vector<double> totals;
    for (std::size_t begin = 0; begin < weights.size(); begin += columns) {
        totals.push_back(columns_.emplace_back(weights.subspan(begin, columns)).total());
    }
    // Scaled, because the sum of a row need not fit a float.
    const double largest = *std::ranges::max_element(totals);
    std::vector<float> rows;
    for (const double total : totals) rows.push_back(largest > 0 ? static_cast<float>(total / largest) : 0.0f);
    rows_ = Distribution1D(rows);
}

Distribution2D::Draw Distribution2D::draw(const Vec2& u) const {
    const Distribution1D::Draw row = rows_.draw(u.y);
    const Distribution1D::Draw column = columns_[row.cell].draw(u.x);
    return {column.cell, row.cell, row.probability * column.probability, Vec2(column.offset, row.offset)};
}

std::uint64_t Distribution2D::memory_bytes() const {
    std::uint64_t bytes = rows_.memory_bytes() + columns_.capacity() * sizeof(Distribution1D);
    for (const Distribution1D& row : columns_) bytes += row.memory_bytes();
    return bytes;
}

}  // namespace rayuela
