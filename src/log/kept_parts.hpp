// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: the rows of a pass, kept for the next one as long as they are not too many.

#include <array>
#include <cstddef>
#include <vector>

#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

class KeptParts {
  public:
    /// Nothing is kept of more than so many numbers.
    explicit KeptParts(std::size_t most_numbers) : most_numbers_(most_numbers) {}

    void add(const TraceView& rows) {
        numbers_ += 4 * rows.size();
        if (numbers_ > most_numbers_) {
            parts_.clear();
            return;
        }
        const auto copy = [](std::span<const double> from) {
            return std::vector<double>(from.begin(), from.end());
        };
        parts_.push_back({copy(rows.time_s), copy(rows.velocity_deg_s), copy(rows.torque_nm),
                          copy(rows.position_deg), !rows.run_starts.empty()});
    }

    [[nodiscard]] bool whole() const { return numbers_ <= most_numbers_ && !parts_.empty(); }

    /// The parts as they were added, but for the rate.
    template <class Use>
    void replay(Hertz sample_rate, const Use& use) const {
        static constexpr std::array<std::size_t, 1> at_first_row = {0};
        for (const Part& part : parts_) {
            TraceView rows{sample_rate, part.time_s, part.velocity_deg_s, part.torque_nm, part.position_deg};
            if (part.begins_run) rows.run_starts = at_first_row;
            use(rows);
        }
    }

  private:
    struct Part {
        std::vector<double> time_s, velocity_deg_s, torque_nm, position_deg;
        bool begins_run;
    };
    std::size_t most_numbers_, numbers_ = 0;
    std::vector<Part> parts_;
};

}  // namespace ripplenotch
