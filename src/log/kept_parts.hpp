// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: the rows of a pass, kept for the next one as long as they are not too many.

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// Gives mapped memory back.
struct Unmapped {
    std::size_t bytes = 0;
    void operator()(double* numbers) const;
};

class KeptParts {
  public:
    /// Nothing is kept of more than so many numbers.
    explicit KeptParts(std::size_t most_numbers) : most_numbers_(most_numbers) {}

    void add(const TraceView& rows) {
        numbers_ += 4 * rows.size();
        if (numbers_ > most_numbers_) {
            parts_.clear();
            room_.reset();
            return;
        }
        parts_.push_back({kept(rows.time_s), kept(rows.velocity_deg_s), kept(rows.torque_nm),
                          kept(rows.position_deg), !rows.run_starts.empty()});
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
        std::span<const double> time_s, velocity_deg_s, torque_nm, position_deg;
        bool begins_run;
    };
    /// A copy that stays where it is.
    [[nodiscard]] std::span<const double> kept(std::span<const double> numbers);

    std::size_t most_numbers_, numbers_ = 0;
    std::vector<Part> parts_;
    std::unique_ptr<double, Unmapped> room_;  ///< for all that may be kept, made when it is needed
    std::size_t used_ = 0;
};

}  // namespace ripplenotch
