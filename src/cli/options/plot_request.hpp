// SPDX-License-Identifier: MIT
#pragma once
// --plot FILE: a command's result as a picture, or in the terminal.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "cli/options/options.hpp"
#include "ripplenotch/chart/track_figure.hpp"
#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

struct PlotRequest {
    std::optional<std::string> path;

    [[nodiscard]] bool wanted() const { return path.has_value(); }
    /// The figure takes the place of data that would go to standard output.
    [[nodiscard]] bool instead_of(const std::string& output) const { return path == "-" && output == "-"; }
};

/// "wide.csv, joint j4": for the title of a figure.
[[nodiscard]] std::string joint_in_words(const std::string& path, const std::string& joint);

void attach_plot(Options& options, PlotRequest& request, const CommonOptions& common);

/// Before any work is done, by attach_plot() already: throws UsageError for a name that is no picture's or
/// --json and the figure both on standard output, FileError for a file that exists and may not be
/// overwritten.
void check_plot(const PlotRequest& request, const CommonOptions& common);

/// Before any file is read: whether the run will tell what it read, as JSON or in the data of a figure. Only
/// then are its inputs hashed, which costs more than reading them.
void hash_where_told(const CommonOptions& common, const PlotRequest& plot = {});

/// Draws what make() gives; does nothing when no plot is asked for. Call it after everything else is written:
/// without gnuplot it writes the figure's data beside where the picture would be and throws FileError.
void draw_plot(const PlotRequest& request, const CommonOptions& common, const Provenance& provenance,
               const std::function<Figure()>& make);

/// Passes rows on to `writer` (which may be null) and keeps what a figure of them needs.
class WatchedWriter : public LogWriter {
  public:
    explicit WatchedWriter(std::unique_ptr<LogWriter> writer) : writer_(std::move(writer)) {}
    std::string_view prepare(RowBlock& block, Torques torque_nm, std::string& room) const override;
    void put(const RowBlock& block, Torques torque_nm, std::string_view bytes) override;
    void finish() override;
    [[nodiscard]] const TorqueCourse& course() const { return course_; }

  private:
    std::unique_ptr<LogWriter> writer_;
    TorqueCourse course_;
};

}  // namespace ripplenotch
