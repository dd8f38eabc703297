// SPDX-License-Identifier: MIT
#pragma once
// What filter is asked to do, and what it does to each joint of a log.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/options/options.hpp"
#include "cli/options/plot_request.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/evaluate/ledger.hpp"
#include "ripplenotch/filter/engine.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"
#include "ripplenotch/verdict/other_ripple.hpp"

namespace ripplenotch {

/// What the command line asks of filter.
struct FilterRequest {
    CommonOptions common;
    PlotRequest plot;
    ReadOptions log;
    std::vector<std::string> logs;
    MethodRequest how;
    std::string decimals = "shortest";
    std::optional<std::string> output_format, metrics, out_directory;
    std::optional<Hertz> crossover;
    Gates gates;
    double gap_steps = default_gap_steps;
    int threads = 0;
    bool append = false, exact = false, in_place = false, require_improvement = false;

    /// Beside the gear of the methods, where they have one in common.
    [[nodiscard]] ReadOptions read_options(const JointMethods& methods) const;
};

inline constexpr std::string_view metrics_ending = ".metrics.json";  ///< in a folder, behind the log's name

/// Where one log comes from and what is made of it.
struct FilterJob {
    std::string log, output;
    std::optional<std::string> metrics;
    bool metrics_in_folder = false;  ///< named after the log, and after the joint where there are several
};

/// One joint of a log on its way through its filter.
struct JointWork {
    CommonOptions common;  ///< that what is said of the joint goes with
    std::shared_ptr<const Contender> method;
    std::unique_ptr<CausalFilter> filter;
    std::unique_ptr<OtherRipple> other_ripple;  ///< null where the method has no map of other motors
    std::optional<RippleMeter> meter;
    FilterMetrics metrics;
    std::optional<std::string> metrics_path;
    std::unique_ptr<ByteSink> metrics_sink;
};

/// Whether a result or an exit code depends on how large the ripple is; else it is measured for warnings
/// alone.
[[nodiscard]] bool must_measure(const FilterRequest& request, const FilterJob& job);

/// The work of each joint that `stream` reads, with its filter ready and its outputs open. `spool` holds the
/// log for a method that looks at all of it first.
[[nodiscard]] std::vector<JointWork> start_works(const FilterRequest& request, const FilterJob& job,
                                                 const LogStream& stream, JointMethods& methods,
                                                 const std::optional<Spool>& spool);

/// The log, the method's files and the command, for what is made of this joint.
[[nodiscard]] Provenance provenance_of(const FilterJob& job, const JointWork& work,
                                       const std::string& command_line);

/// Says and writes what became of a joint; true when everything is within the limits.
bool tell(const FilterRequest& request, const FilterJob& job, JointWork& work,
          const std::string& command_line);

}  // namespace ripplenotch
