#pragma once

#include <cmath>
#include <limits>
#include <vector>

namespace rayuela::test {

/// Regularized upper incomplete gamma function Q(a, x), by its series or Lentz's continued fraction.
inline double gamma_q(double a, double x) {
    if (x <= 0) return 1;
    const double scale = std::exp(-x + a * std::log(x) - std::lgamma(a));
    if (x < a + 1) {
        double term = 1 / a, sum = term;
        for (double n = a + 1; term > sum * 1e-15; ++n) sum += term *= x / n;
        return 1 - sum * scale;
    }
    double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;
    for (int i = 1; i < 10000; ++i) {
        const double an = -i * (i - a);
        b += 2;
        d = 1 / (an * d + b);
        c = b + an / c;
        h *= d * c;
        if (std::abs(d * c - 1) < 1e-15) break;
    }
    return scale * h;
}

/// Probability of a chi-square statistic as large by chance.
inline double chi_square_p_value(double statistic, int degrees_of_freedom) {
    return gamma_q(0.5 * degrees_of_freedom, 0.5 * statistic);
}

/// The level of each of `tests` independent tests at which all together fail by chance with probability `alpha`.
inline double sidak(double alpha, int tests) {
    return 1 - std::pow(1 - alpha, 1.0 / tests);
}

/// Pearson's test of counts against expectations, cells expected below 5 pooled. 0 where something fell into cells that
/// expect nothing.
inline double chi_square_test(const std::vector<double>& observed, const std::vector<double>& expected) {
    double statistic = 0, pooled_observed = 0, pooled_expected = 0;
    int cells = 0;
    const auto add = [&](double o, double e) {
        statistic += (o - e) * (o - e) / e;
        ++cells;
    };
    for (std::size_t i = 0; i < observed.size(); ++i) {
        if (expected[i] >= 5) {
            add(observed[i], expected[i]);
        } else {
            pooled_observed += observed[i];
            pooled_expected += expected[i];
        }
    }
    if (pooled_expected >= 5) {
        add(pooled_observed, pooled_expected);
    } else if (pooled_observed > pooled_expected + 6 * std::sqrt(pooled_expected) + 3) {
        return 0;
    }
    return cells > 1 ? chi_square_p_value(statistic, cells - 1) : 1;
}

/// Mean and its standard error.
class Moments {
public:
    void add(double x) {
        ++n_;
        const double delta = x - mean_;
        mean_ += delta / static_cast<double>(n_);
        m2_ += delta * (x - mean_);
    }
    double mean() const { return mean_; }
    double error() const { return std::sqrt(m2_ / static_cast<double>(n_) / static_cast<double>(n_ - 1)); }

private:
    long n_ = 0;
    double mean_ = 0, m2_ = 0;
};

}  // namespace rayuela::test
