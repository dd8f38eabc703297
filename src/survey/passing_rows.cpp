// SPDX-License-Identifier: MIT
#include "survey/passing_rows.hpp"

#include <algorithm>
#include <utility>

namespace ripplenotch {
namespace {

constexpr double stride_s = 0.01;  // noise of a position at rest must not add up to turns

}  // namespace

PassingRows::PassingRows(const LogFacts& facts, std::size_t most_means)
    : rows_(facts.rows),
      in_mean_((facts.rows + most_means - 1) / most_means),
      stride_(static_cast<std::size_t>(std::max(1.0, stride_s * facts.sample_rate.value()))),
      rate_hz_(facts.sample_rate.value()) {
    means_.sample_rate = Hertz(rate_hz_ / static_cast<double>(in_mean_));
}

void PassingRows::Extremes::add(double value) {
    if (!any) known = std::isfinite(value);
    any = true;
    low = std::min(low, value);
    high = std::max(high, value);
}

std::optional<Range> PassingRows::Extremes::range() const {
    if (!known) return std::nullopt;
    return Range{low, high};
}

// Each stride_-th row and the last, as in a log that is held.
void PassingRows::add_turns(const TraceView& rows, std::size_t k) {
    if (!rows.has_position()) {
        if (rate_hz_ > 0.0 && speed_.known) moved_deg_ += std::abs(rows.velocity_deg_s[k]) / rate_hz_;
        return;
    }
    by_position_ = true;
    if (at_ == 0) strode_from_deg_ = rows.position_deg[k];
    if (at_ % stride_ != 0 && at_ + 1 != rows_) return;
    moved_deg_ += std::abs(rows.position_deg[k] - strode_from_deg_);
    strode_from_deg_ = rows.position_deg[k];
}

void PassingRows::add(const TraceView& rows) {
    begins_run_ = begins_run_ || (!rows.run_starts.empty() && at_ > 0);
    for (std::size_t k = 0; k < rows.size(); ++k, ++at_) {
        speed_.add(rows.velocity_deg_s[k]);
        torque_.add(rows.torque_nm[k]);
        add_turns(rows, k);
        sums_.time_s += rows.time_s[k];
        sums_.velocity_deg_s += rows.velocity_deg_s[k];
        sums_.torque_nm += rows.torque_nm[k];
        if (rows.has_position()) sums_.position_deg += rows.position_deg[k];
        if (++sums_.rows == in_mean_) end_mean();
    }
}

// A gap within the rows of a mean is told by the one before it, which is near enough for a stretch of
// seconds.
void PassingRows::end_mean() {
    const auto rows = static_cast<double>(sums_.rows);
    if (std::exchange(begins_run_, false) && means_.size() > 0) means_.run_starts.push_back(means_.size());
    means_.time_s.push_back(sums_.time_s / rows);
    means_.velocity_deg_s.push_back(sums_.velocity_deg_s / rows);
    means_.torque_nm.push_back(sums_.torque_nm / rows);
    if (by_position_) means_.position_deg.push_back(sums_.position_deg / rows);
    sums_ = {};
}

double PassingRows::turns() const { return moved_deg_ / 360.0; }

Trace PassingRows::take_means() {
    if (sums_.rows > 0) end_mean();
    return std::move(means_);
}

}  // namespace ripplenotch
