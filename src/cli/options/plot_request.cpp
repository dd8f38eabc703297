// SPDX-License-Identifier: MIT
#include "cli/options/plot_request.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "cli/talk.hpp"
#include "core/text/lower_case.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/document/figure_json.hpp"
#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {
namespace {

std::string extension_of(const std::string& path) {
    return lower_case(std::filesystem::path(path).extension().string());
}

std::optional<PictureKind> picture_kind(const std::string& path) {
    const std::string extension = extension_of(path);
    if (extension == ".svg") return PictureKind::svg;
    if (extension == ".png") return PictureKind::png;
    if (extension == ".pdf") return PictureKind::pdf;
    return std::nullopt;
}

std::string data_path(const std::string& path) {
    return std::filesystem::path(path).replace_extension(".json").string();
}

constexpr const char* how_to_install = "install gnuplot (on Debian: apt-get install gnuplot-nox)";

}  // namespace

std::string joint_in_words(const std::string& path, const std::string& joint) {
    return joint.empty() ? path : path + ", joint " + joint;
}

void attach_plot(Options& options, PlotRequest& request, const CommonOptions& common) {
    const Options::Group group(options, output_group);
    options.text("--plot", request.path, "FILE",
                 fmt::format("the result as a picture ({}): FILE.svg, .png or .pdf by gnuplot, FILE.json for "
                             "the data of the figure; - draws it in the terminal",
                             figures_of(options.command_name())));
    options.writes("--plot");
    options.after_parse([&] { check_plot(request, common); });
}

void check_plot(const PlotRequest& request, const CommonOptions& common) {
    if (!request.path) return;
    const std::string& path = *request.path;
    if (path == "-") {
        if (common.json && common.output == "-") {
            raise<UsageError>(
                "--plot - and --json would both go to standard output; name a file with -o or --plot");
        }
        return;
    }
    if (!picture_kind(path) && extension_of(path) != ".json") {
        raise<UsageError>(
            "--plot {}: the name ends in neither .svg, .png, .pdf nor .json (the figure's data); - is the "
            "terminal",
            path);
    }
    if (path == common.output) raise<UsageError>("--plot and -o both name {}", path);
    if (!common.force && std::filesystem::exists(path)) {
        raise<FileError>("{}: exists already; choose another name or overwrite it with --force", path);
    }
}

void hash_where_told(const CommonOptions& common, const PlotRequest& plot) {
    hash_inputs(common.json || ends_with_json(common.output) || plot.wanted());
}

void draw_plot(const PlotRequest& request, const CommonOptions& common, const Provenance& provenance,
               const std::function<Figure()>& make) {
    if (!request.path) return;
    const std::string& path = *request.path;
    const Figure figure = make();
    require_listed_figure(figure.name);
    const auto data = [&] { return figure_text(figure, provenance); };
    if (extension_of(path) == ".json") {
        write_all(path, data(), common.overwrite());
        return;
    }
    // A pipe gets 80 columns whoever reads it, so that the same input gives the same bytes.
    const auto drawn = path == "-" ? draw_text(figure, static_cast<int>(terminal_columns().value_or(80)))
                                   : draw_picture(figure, *picture_kind(path));
    if (drawn) {
        write_all(path, *drawn, common.overwrite());
        return;
    }
    if (path == "-") raise<FileError>("--plot -: there is no gnuplot to draw with; {}", how_to_install);
    // The result may have that name.
    const std::string data_file = data_path(path) == common.output ? path + ".json" : data_path(path);
    write_all(data_file, data(), common.overwrite());
    raise<FileError>("{}: there is no gnuplot to draw it with, its data are in {}; {}", path, data_file,
                     how_to_install);
}

std::string_view WatchedWriter::prepare(RowBlock& block, Torques torque_nm, std::string& room) const {
    return writer_ ? writer_->prepare(block, torque_nm, room) : std::string_view{};
}

void WatchedWriter::put(const RowBlock& block, Torques torque_nm, std::string_view bytes) {
    const JointRows& joint = block.joints.front();
    for (std::size_t k = 0; k < block.size(); ++k)
        course_.add({.time_s = block.time_s[k],
                     .speed_deg_s = joint.velocity_deg_s[k],
                     .before_nm = joint.torque_nm[k],
                     .after_nm = torque_nm.front()[k]});
    if (writer_) writer_->put(block, torque_nm, bytes);
}

void WatchedWriter::finish() {
    if (writer_) writer_->finish();
}

}  // namespace ripplenotch
