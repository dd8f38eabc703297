// SPDX-License-Identifier: MIT
#include "log/row_cut.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t fewest_rows = 2;  // a log of one row has no rate

// Stamps in ms times 0.001 are not always the nearest numbers to what people type in seconds.
double slack(double time_s, double bound_s) {
    constexpr double some_ulps = 4.0 * std::numeric_limits<double>::epsilon();
    return some_ulps * std::max(std::abs(time_s), std::abs(bound_s));
}

}  // namespace

RowCut::RowCut(const ReadOptions& options, const Layout& whole)
    : source_(whole.source), range_(options.range) {
    if (whole.stated_rate) {
        rate_hz_ = whole.stated_rate->value();
    } else if (whole.chosen.time) {
        factor_ = whole.columns[*whole.chosen.time].factor;
        axis_.origin_s = whole.time_origin;
    } else {
        raise<DataError>("{}: {}: no column is the time; say --columns time=NAME, or --sample-rate 1kHz",
                         source_, asked());
    }
}

bool RowCut::keeps(std::optional<double> time) {
    if (rate_hz_) time = static_cast<double>(rows_) / *rate_hz_;
    ++rows_;
    if (time) {
        const double time_s = rate_hz_ ? *time : *time * factor_;
        if (!first_s_) begin(time_s);
        last_s_ = time_s;
        place_ = place_of(time_s);
        if (rate_hz_ && kept_ == 0 && inside()) outside_->zero_s = time_s;
    }
    if (inside())
        ++kept_;
    else
        ++(place_ == Place::before ? outside_->before : outside_->after);
    return inside();
}

RowCut::Place RowCut::place_of(double time_s) const {
    if (range_.from && time_s < from_s_ - slack(time_s, from_s_)) return Place::before;
    if (range_.to && time_s > to_s_ + slack(time_s, to_s_)) return Place::after;
    return Place::inside;
}

void RowCut::begin(double first_s) {
    first_s_ = first_s;
    const auto bound = [&](const std::optional<TimePoint>& point, std::string_view option, double& bound_s) {
        if (!point) return std::optional<double>();
        const std::string label = fmt::format("{}: {}", source_, option);
        bound_s = on_axis(*point, axis_, label);
        if (bound_s < 0.0 && first_s >= 0.0)
            raise<UsageError>("{} {} is below 0 s, and the log begins at {} s; write a time from there on",
                              label, point->text, shortest(first_s));
        return std::optional<double>(bound_s);
    };
    outside_->from_s = bound(range_.from, "--from", from_s_);
    outside_->to_s = bound(range_.to, "--to", to_s_);
    if (from_s_ > to_s_)
        raise<UsageError>("{}: {}: the range ends at {} s, before it begins at {} s; swap the two", source_,
                          asked(), shortest(to_s_), shortest(from_s_));
}

std::string RowCut::asked() const {
    const auto words = [](const std::optional<TimePoint>& point, std::string_view option) {
        return point ? fmt::format("{} {}", option, point->text) : std::string();
    };
    const std::string from = words(range_.from, "--from"), to = words(range_.to, "--to");
    return from + (from.empty() || to.empty() ? "" : " ") + to;
}

void RowCut::require_rows() const {
    if (kept_ >= fewest_rows) return;
    const std::string what = kept_ == 0 ? "no row" : "one row only";
    if (!first_s_)
        raise<DataError>("{}: {} keeps {}: no row has a time; check the time column", source_, asked(), what);
    raise<UsageError>("{}: {} keeps {}: the log covers {} s to {} s in {} rows; ask for two of them or more",
                      source_, asked(), what, shortest(*first_s_), shortest(last_s_), rows_);
}

ReadOptions clock_only(ReadOptions options) {
    options.joint.reset();
    options.every_joint = false;
    options.needs_torque = false;
    return options;
}

std::string range_in_words(const RowsOutside& outside) {
    std::string words = "only rows";
    if (outside.from_s) words += fmt::format(" from {} s", shortest(*outside.from_s));
    if (outside.to_s) words += fmt::format(" to {} s", shortest(*outside.to_s));
    if (outside.zero_s != 0.0) words += fmt::format("; times count from {} s", shortest(outside.zero_s));
    return words;
}

void KeptNumbers::add(bool kept) {
    ++seen_;
    if (!kept) return;
    const std::size_t left_out = seen_ - ++kept_;
    const std::size_t before = holes_.empty() ? 0 : holes_.back().left_out;
    if (left_out == before) return;
    const std::lock_guard lock(mutex_);
    holes_.push_back({kept_ - 1, left_out});
}

std::size_t KeptNumbers::in_file(std::size_t number) const {
    const std::lock_guard lock(mutex_);
    for (auto hole = holes_.rbegin(); hole != holes_.rend(); ++hole) {
        if (number > hole->kept) return number + hole->left_out;
    }
    return number;
}

}  // namespace ripplenotch
