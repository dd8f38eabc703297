// SPDX-License-Identifier: MIT
#pragma once
// Size and colour of the noise of a log, from the residual of a model of far too many terms: estimated from
// the residual of the current model, the noise would grow with the missing terms.

#include <concepts>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "diagnose/case/case.hpp"
#include "diagnose/case/lines.hpp"

namespace ripplenotch {

// The many columns whose residual is only the noise of a log, and that residual. There are over a hundred,
// each as long as the log, and they are added in turns: products that were summed up once are kept.

class NoiseColumns {
  public:
    /// Rows with 0 in `use` count for nothing. It must outlive this.
    explicit NoiseColumns(std::span<const unsigned char> use) : use_(use) {}

    /// A column of a number a row, scaled to an rms of 1; nothing when it is 0 everywhere, or not finite.
    void add(std::vector<double> column);
    /// The same of value_at(row).
    template <class Function>
    requires std::invocable<Function, std::size_t>
    void add(const Function& value_at) {
        std::vector<double> column(use_.size());
        for (std::size_t k = 0; k < column.size(); ++k) column[k] = value_at(k);
        add(std::move(column));
    }
    /// Forgets all columns but the first `count`.
    void cut(std::size_t count);

    [[nodiscard]] std::size_t count() const { return columns_.size(); }

    /// The torque that no sum of the columns explains, by least squares with a touch of ridge; 0 in rows that
    /// do not count.
    [[nodiscard]] std::vector<double> left_of(std::span<const double> torque_nm);

  private:
    /// Rows at a time: of all columns they stay in the second cache.
    static constexpr std::size_t block_rows = 256;

    void sum_products();

    std::span<const unsigned char> use_;
    std::vector<std::vector<double>> columns_;
    std::vector<std::vector<double>> products_;  ///< products of each column with those up to it
};

// The columns of a model of far too many terms for a case, whatever the current model: ripple of orders about
// the stated ones whose amplitude varies with each variable of the motion, and smooth functions of position,
// speed and time.

/// Cosine and sine at every sample, of `cycles` for one of `where`.
struct NoiseWave {
    NoiseWave(std::span<const double> where, double cycles);
    std::vector<double> cosine, sine;
};

void add_wave(NoiseColumns& columns, const NoiseWave& wave);

/// The columns of one case, and their products, kept between two estimates of its noise: most of the cost of
/// an estimate.
class NoiseGround {
  public:
    /// The columns, and nothing behind them. The case must outlive them, and stay as it is.
    [[nodiscard]] NoiseColumns& columns(const Case& looked_at, const StatedRipple& ripple);

  private:
    StatedRipple ripple_;
    std::optional<NoiseColumns> columns_;
    std::size_t count_ = 0;
};

struct NoiseFloor {
    double rms_nm = 0.0;                      ///< rms of the noise
    double white_nm = 0.0;                    ///< rms of its white part
    std::vector<double> color;                ///< coefficients of FitOptions::noise_color
    double material_nm = 0.0;                 ///< rms against which a torque matters or not; 0: rms_nm
    std::vector<double> covariance_nm2 = {};  ///< at lags 0, 1, ... samples

    /// The whitening filter of every step-th sample, of at most this many lags.
    struct Thinned {
        std::vector<double> color;
        double white_nm = 0.0;
        double density_nm2 = 0.0;  ///< power spectral density at 0 Hz, in Nm^2 times the full sample period
    };
    [[nodiscard]] Thinned thinned(std::size_t step, std::size_t most_lags, double samples,
                                  double lag_price) const;

    /// Variance of a sum over many samples, against that of white noise of the same rms; at least 1.
    [[nodiscard]] double of_sums() const;
};

/// `model`: the best one so far, wholly stated; its own slopes take part.
[[nodiscard]] NoiseFloor noise_floor(const Case& looked_at, const Model& model, const Model& open);
/// The same, where the noise of this case is estimated repeatedly.
[[nodiscard]] NoiseFloor noise_floor(const Case& looked_at, const Model& model, const Model& open,
                                     NoiseGround& ground);

/// Where the best model leaves more than noise: its residual, as noise with a correlation time of `memory_s`.
/// Names are weighted where it is quiet.
[[nodiscard]] NoiseFloor noise_of_residual(const Case& looked_at, const std::vector<double>& residual_nm,
                                           const NoiseFloor& floor);

}  // namespace ripplenotch
