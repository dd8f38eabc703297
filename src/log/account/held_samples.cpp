// SPDX-License-Identifier: MIT
#include "log/account/account.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr double moving_deg_s = 0.2;           // by hand: slower is a rest
constexpr std::size_t judged_changes = 16384;  ///< enough to know how coarse a torque is
constexpr std::size_t fewest_changes = 8;      // by hand
constexpr double coarse_steps = 10.0;          ///< a usual change of fewer smallest ones
/// Of the torque's changes; by chance half of them at most meet those of a channel that changes less often.
constexpr double changing_together = 0.9;

}  // namespace

HeldCounter::Row HeldCounter::row_of(const TraceView& rows, std::size_t k) {
    return {rows.velocity_deg_s[k], rows.torque_nm[k], rows.has_position() ? rows.position_deg[k] : 0.0,
            rows.time_s[k]};
}

void HeldCounter::count(const TraceView& rows, bool begins_run) {
    if (rows.size() == 0) return;
    has_position_ = rows.has_position();
    if (by_position_ && has_position_) {
        std::size_t k = 0;
        if (!any_ || begins_run) {
            last_ = row_of(rows, k++);
            stretch_ = {.since_s = last_.time_s};
            any_ = true;
        }
        for (; k < rows.size(); ++k) {
            const Row before = std::exchange(last_, row_of(rows, k));
            count_by_position(before, last_);
        }
        return;
    }
    if (any_ && !begins_run) {
        const Row now = row_of(rows, 0);
        const std::array velocity = {last_.velocity, now.velocity}, torque = {last_.torque, now.torque},
                         position = {last_.position, now.position};
        count_pairs({velocity.data(), torque.data(), has_position_ ? position.data() : nullptr}, 1);
    } else {
        run_ = {};
    }
    count_pairs({rows.velocity_deg_s.data(), rows.torque_nm.data(),
                 has_position_ ? rows.position_deg.data() : nullptr},
                rows.size() - 1);
    last_ = row_of(rows, rows.size() - 1);
    any_ = true;
}

void HeldCounter::count_pairs(const RowChannels& rows, std::size_t pairs) {
    const RepeatCounts counts = count_repeats(rows, pairs, moving_deg_s);
    counts_ += counts;
    if (counts.torque > 0)
        measure_runs(rows, pairs);
    else if (pairs > 0)
        run_ = {};
    if (changes_.size() < judged_changes) note_changes(rows, pairs);
}

void HeldCounter::count_by_position(const Row& before, const Row& now) {
    const bool torque = before.torque == now.torque, position = before.position == now.position;
    if (!torque && changes_.size() < judged_changes) changes_.push_back(std::abs(now.torque - before.torque));
    for (const Way way : {torque_alone, with_position}) {
        run_[way] = torque && (position || way == torque_alone) ? run_[way] + 1 : 0;
        if (way == with_position) stretch_.longest = std::max(stretch_.longest, run_[way]);
    }
    if (position) {
        ++stretch_.pairs;
        stretch_.torque += torque ? 1 : 0;
        return;
    }
    const double passed_s = now.time_s - stretch_.since_s;
    if (std::abs(now.position - before.position) > moving_deg_s * passed_s) {
        counts_.moving += stretch_.pairs + 1;
        counts_.position += stretch_.pairs;
        counts_.torque += stretch_.torque + (torque ? 1 : 0);
        counts_.position_and_torque += stretch_.torque;
        counts_.velocity = counts_.moving;  // which says nothing of its own
        counts_.velocity_and_torque = counts_.torque;
        longest_[with_position] = std::max(longest_[with_position], stretch_.longest);
        longest_[torque_alone] = std::max(longest_[torque_alone], run_[torque_alone]);
    }
    stretch_ = {.since_s = now.time_s};
}

void HeldCounter::measure_runs(const RowChannels& rows, std::size_t pairs) {
    const auto same = [](const double* values, std::size_t k) {
        return values != nullptr && values[k] == values[k + 1];
    };
    for (std::size_t k = 0; k < pairs; ++k) {
        const double speed = std::min(std::abs(rows.velocity_deg_s[k]), std::abs(rows.velocity_deg_s[k + 1]));
        const bool torque = speed > moving_deg_s && same(rows.torque_nm, k);
        const bool velocity = torque && same(rows.velocity_deg_s, k);
        const bool position = torque && same(rows.position_deg, k);
        const std::array held = {torque, velocity, position, velocity && position};
        for (std::size_t way = 0; way < held.size(); ++way) {
            run_[way] = held[way] ? run_[way] + 1 : 0;
            longest_[way] = std::max(longest_[way], run_[way]);
        }
    }
}

void HeldCounter::note_changes(const RowChannels& rows, std::size_t pairs) {
    for (std::size_t k = 0; k < pairs && changes_.size() < judged_changes; ++k) {
        const double speed = std::min(std::abs(rows.velocity_deg_s[k]), std::abs(rows.velocity_deg_s[k + 1]));
        const double change = std::abs(rows.torque_nm[k + 1] - rows.torque_nm[k]);
        if (speed > moving_deg_s && change > 0.0) changes_.push_back(change);
    }
}

// Of a sample written several times, all channels change in one row or in none.
bool HeldCounter::is_evidence(std::size_t repeats, std::size_t with_torque) const {
    const std::size_t changes = counts_.moving - repeats, of_torque = counts_.moving - counts_.torque;
    if (2 * repeats < counts_.moving) return true;
    const auto both = static_cast<double>(changes + with_torque) - static_cast<double>(counts_.torque);
    return of_torque >= fewest_changes && both >= changing_together * static_cast<double>(of_torque);
}

HeldCounter::Way HeldCounter::way() const {
    const bool velocity_is_evidence = is_evidence(counts_.velocity, counts_.velocity_and_torque);
    const bool position_is_evidence =
        has_position_ && is_evidence(counts_.position, counts_.position_and_torque);
    if (velocity_is_evidence) return position_is_evidence ? with_both : with_velocity;
    return position_is_evidence ? with_position : torque_alone;
}

bool HeldCounter::torque_is_coarse() const {
    if (changes_.size() < fewest_changes) return true;
    std::vector<double> changes = changes_;
    return median_in(changes) < coarse_steps * *std::ranges::min_element(changes);
}

HeldSamples HeldCounter::held() const {
    const std::array counts = {counts_.torque, counts_.velocity_and_torque, counts_.position_and_torque,
                               counts_.all};
    const Way chosen = way();
    if (chosen == torque_alone && counts_.torque > 0 && torque_is_coarse()) return {};
    return {counts[chosen], longest_[chosen], counts_.moving};
}

}  // namespace ripplenotch
