// SPDX-License-Identifier: MIT
#pragma once
// A residual against time, as tones are looked for in it. Of a log with long gaps it is the mean of the
// spectra of its pieces: a spectrum of the whole would be a comb of lines, or end below what the sampling
// resolves.

#include <cstddef>
#include <vector>

#include "diagnose/case/line_spectrum.hpp"

namespace ripplenotch {

class Tones {
  public:
    /// LineSamples against time in s, in its order.
    Tones(LineSamples samples, double rate_hz, const LineRules& rules);

    /// In Hz and Nm^2.
    [[nodiscard]] const LineSpectrum& spectrum() const { return spectrum_; }
    /// The frequency about a cell of the spectrum; of pieces the one at which they agree best.
    [[nodiscard]] double refined_hz(std::size_t cell) const;

  private:
    [[nodiscard]] double agreed_hz(double mean_hz, double error_hz) const;

    const LineRules& rules_;
    LineSamples all_;
    std::vector<LineSamples> pieces_;  ///< none where the whole is looked at
    LineSpectrum spectrum_;
};

}  // namespace ripplenotch
