// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string>

#include "cli/options/options.hpp"
#include "ripplenotch/analysis/frequency_response.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"

namespace ripplenotch {

// spectrum --response: its options, and the response as a table or CSV.

struct ResponseRequest {
    std::optional<std::string> signals;  ///< "OUT/IN"; nothing without it
    std::string estimator = "h1";
    std::optional<std::string> method;  ///< whose predicted response is shown with the measured one
    std::optional<Seconds> segment;
    std::optional<Hertz> resolution;

    /// Whether a signal has this name.
    [[nodiscard]] bool names(std::string_view signal) const;
    /// Whether the joint's motion has to be in the log.
    [[nodiscard]] bool needs_motion(const GearOptions& gear) const;
};

void attach_response(Options& options, ResponseRequest& request);

/// A log whose roles are read; columns by name are read from it again.
struct ResponseLog {
    const std::string& path;
    const ReadOptions& reading;
    const Log& log;
};
/// Throws UsageError where OUT/IN names no two signals of the log, and what frequency_response throws.
[[nodiscard]] ResponseReport response_report(const ResponseRequest& request, const GearOptions& gear,
                                             const ResponseLog& read);

[[nodiscard]] std::string response_table(const ResponseReport& report);
[[nodiscard]] std::string response_csv(const ResponseReport& report);

}  // namespace ripplenotch
