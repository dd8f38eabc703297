// SPDX-License-Identifier: MIT
#include "cli/spectrum/streamed_spectrum.hpp"

#include <optional>

#include "ripplenotch/analysis/spectrum_stream.hpp"
#include "ripplenotch/filter/engine.hpp"

namespace ripplenotch {
namespace {

/// Pieces are cut in the first pass already, at the rate that the first rows have. Longer ones wait until it
/// is known that the log is as long.
constexpr std::size_t longest_guessed = std::size_t{1} << 17;

class GuessedSpectrum {
  public:
    explicit GuessedSpectrum(const SpectrumOptions& options) : options_(options) {}

    void add(const TraceView& rows) {
        if (length_ == 0) length_ = begin(rows);
        if (stream_) stream_->add(rows.time_s, rows.torque_nm);
    }
    /// What the first pass has added up, when the guess was good enough to make no difference.
    [[nodiscard]] std::optional<SpectrumStream> settled(std::size_t length, Hertz rate) {
        if (!stream_ || length_ != length || !stream_->settle(rate)) return std::nullopt;
        return std::move(stream_);
    }

  private:
    std::size_t begin(const TraceView& rows) {
        const double duration = rows.time_s.back() - rows.time_s.front();
        const Hertz rate = nominal_rate(Hertz(static_cast<double>(rows.size() - 1) / duration));
        const bool known = duration > 0.0;
        const std::size_t length = known ? piece_length(longest_guessed + 1, rate, options_) : 1;
        if (known && length >= fewest_spectrum_samples && length <= longest_guessed)
            stream_.emplace(length, rate);
        return length;
    }

    SpectrumOptions options_;
    std::size_t length_ = 0;
    std::optional<SpectrumStream> stream_;
};

}  // namespace

StretchSpectrum streamed_spectrum(LogPasses& log, const SpectrumOptions& options,
                                  const std::function<void()>& tell) {
    GuessedSpectrum guess(options);
    log.first([&](const TraceView& rows) { guess.add(rows); });
    const LogFacts& facts = log.facts();
    const std::size_t length = piece_length(facts.rows, facts.sample_rate, options);
    const bool enough = length >= fewest_spectrum_samples;
    std::optional<SpectrumStream> stream = guess.settled(length, facts.sample_rate);
    const bool added = stream.has_value(), lines = added && stream->find_lines(options.false_alarm);
    if (enough && !added) stream.emplace(length, facts.sample_rate);

    StretchMeter speed(facts.rows, Seconds(facts.mean_s), Degrees(facts.mean_position_deg));
    log.second([&](const TraceView& rows) {
        speed.add(rows);
        if (enough && !added) stream->add(rows.time_s, rows.torque_nm);
        if (lines) stream->measure(rows.time_s, rows.torque_nm);
    });
    tell();
    require_piece_length(length, options);
    if (!added && stream->find_lines(options.false_alarm))
        log.again([&](const TraceView& rows) { stream->measure(rows.time_s, rows.torque_nm); });
    return {std::nullopt, speed.stretch(facts.sample_rate), stream->spectrum()};
}

}  // namespace ripplenotch
