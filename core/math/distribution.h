#pragma once

#include "core/math/vec.h"

#include <cstdint>
#include <span>
#include <vector>

namespace rayuela {

/// Draws an index in proportion to its weight in constant time. Vose, "A linear algorithm for generating random numbers
/// with a given distribution", IEEE TSE 17(9), 1991.
class AliasTable {
public:
    struct Draw {
        std::uint32_t index;
        float probability;
        float remainder;  ///< What the choice leaves of u, in [0, 1): uniform, and stratified where u was.
    };

    AliasTable() = default;
    /// Weights that are negative, NaN or infinite count as 0. Without any positive weight the table is empty.
    explicit AliasTable(std::span<const float> weights);

    bool empty() const { return slots_.empty(); }
    /// `u` in [0, 1). Never draws an index of weight 0. Not to be called on an empty table.
    Draw draw(float u) const;
    float probability(std::uint32_t index) const { return slots_[index].probability; }
    std::uint64_t memory_bytes() const { return slots_.capacity() * sizeof(Slot); }

private:
    struct Slot {
        float threshold;      ///< Share of the slot that is its own index.
        std::uint32_t alias;  ///< The index that has the rest.
        float probability;    ///< Of the slot's own index.
    };
    std::vector<Slot> slots_;
};

/// Piecewise constant density over [0, 1) in n equal cells, drawn by inversion: stratified numbers stay stratified.
class Distribution1D {
public:
    struct Draw {
        std::uint32_t cell;
        float probability;  ///< Of the cell.
        float offset;       ///< Position within the cell, in [0, 1).
    };

    Distribution1D() = default;
    /// Weights as for AliasTable.
    explicit Distribution1D(std::span<const float> weights);

    /// Sum of the weights.
    double total() const { return total_; }
    /// `u` in [0, 1). Never draws a cell of probability 0. Not to be called when total() is 0.
    Draw draw(float u) const;
    /// The share of u that draws the cell, exactly.
    float probability(std::uint32_t cell) const { return cdf_[cell + 1] - cdf_[cell]; }
    std::uint64_t memory_bytes() const { return cdf_.capacity() * sizeof(float); }

private:
    std::vector<float> cdf_;  ///< n + 1 values from 0 to 1.
    double total_ = 0;
};

/// The same over a grid of cells: first a row, then a column.
class Distribution2D {
public:
    struct Draw {
        std::uint32_t column, row;
        float probability;
        Vec2 offset;
    };

    Distribution2D() = default;
    /// Row-major weights; weights.size() is a multiple of `columns` > 0.
    Distribution2D(std::span<const float> weights, std::uint32_t columns);

    double total() const { return rows_.total(); }
    Draw draw(const Vec2& u) const;
    float probability(std::uint32_t column, std::uint32_t row) const {
        return rows_.probability(row) * columns_[row].probability(column);
    }
    std::uint64_t memory_bytes() const;

private:
    Distribution1D rows_;
    std::vector<Distribution1D> columns_;  ///< One a row.
};

}  // namespace rayuela
