// SPDX-License-Identifier: MIT
#include "cli/command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "cli/talk.hpp"
#include "core/text/lower_case.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/document/results.hpp"
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

constexpr const char* how_to_install = "install gnuplot (on Debian: apt-get install gnuplot-nox)";

// Before any work is done.
void check_plot(const CommonOptions& common) {
    if (!common.plot) return;
    const std::string& path = *common.plot;
    if (path == "-" && common.json && common.output == "-")
        raise<UsageError>(
            "--plot - and --json would both go to standard output; name a file with -o or --plot");
    if (path != "-" && !picture_kind(path) && extension_of(path) != ".json")
        raise<UsageError>(
            "--plot {}: the name ends in neither .svg, .png, .pdf nor .json (the figure's data); - is the "
            "terminal",
            path);
    if (path != "-" && path == common.output) raise<UsageError>("--plot and -o both name {}", path);
}

void draw_figure(const Answer& answer, const std::string& path, const CommonOptions& common) {
    if (extension_of(path) == ".json") return write_all(path, figure_data(answer), common.overwrite());
    const Figure figure = answer.figure();
    // A pipe gets 80 columns whoever reads it, so that the same input gives the same bytes.
    const auto drawn = path == "-" ? draw_text(figure, static_cast<int>(terminal_columns().value_or(80)))
                                   : draw_picture(figure, *picture_kind(path));
    if (drawn) return write_all(path, *drawn, common.overwrite());
    if (path == "-") raise<FileError>("--plot -: there is no gnuplot to draw with; {}", how_to_install);
    // The result may have that name.
    std::string data_file = std::filesystem::path(path).replace_extension(".json").string();
    if (data_file == common.output) data_file = path + ".json";
    write_all(data_file, figure_data(answer), common.overwrite());
    raise<FileError>("{}: there is no gnuplot to draw it with, its data are in {}; {}", path, data_file,
                     how_to_install);
}

void write_columns(const Answer& answer, const std::string& path, const CommonOptions& common) {
    ByteSink sink(path, common.overwrite(), answer.format->binary);
    answer.format->write_columns(sink, answer.columns);
    sink.finish();
}

void write_main(const Answer& answer, const std::string& path, const CommonOptions& common) {
    const bool of_numbers = answer.format != nullptr || answer.kind == Answer::Text::rows;
    if (answer.document && (common.json || ends_with_json(path)))
        write_text(path, answer.document(), common.overwrite());
    else if (of_numbers && common.figure_for_rows())
        return;
    else if (answer.format != nullptr)
        write_columns(answer, path, common);
    else if (answer.kind == Answer::Text::bytes)
        write_all(path, answer.text, common.overwrite());
    else
        write_text(path, answer.text, common.overwrite());
}

}  // namespace

void attach_plot(Options& options, CommonOptions& common) {
    const Options::Group group(options, output_group);
    options.text("--plot", common.plot, "FILE",
                 fmt::format("the result as a picture ({}): FILE.svg, .png or .pdf by gnuplot, FILE.json for "
                             "the data of the figure; - draws it in the terminal",
                             figures_of(options.command_name())));
    options.writes("--plot");
    options.after_parse([&] { check_plot(common); });
}

ExitCode give(const Answer& answer, const CommonOptions& common) {
    // One answer, or where a name holds {joint} those of all joints.
    const auto each = [&](const std::string& path, const auto& write) {
        if (!names_joint(path)) return write(answer, path);
        for (const Answer& one : answer.joints) write(one, with_joint(path, one.joint));
        if (answer.joints.empty() && answer.document) write(answer, with_joint(path, answer.joint));
    };
    for (const Answer::File& file : answer.files) {
        write_text(file.path, file.text, common.overwrite());
        if (!file.said.empty()) say(common, file.said);
    }
    if (answer.own_output) {
        if (answer.format != nullptr) write_columns(answer, common.output, common);
        const std::string text = common.json && answer.document ? answer.document() : answer.text;
        if (!text.empty()) write_text("-", text, ByteSink::Overwrite::no);
    } else {
        each(common.output,
             [&](const Answer& one, const std::string& path) { write_main(one, path, common); });
        // The file is for the next command; people still want to read what came out.
        if ((answer.document || !answer.joints.empty()) && ends_with_json(common.output) && !common.json)
            write_text("-", answer.text, ByteSink::Overwrite::no);
    }
    if (common.plot)
        each(*common.plot,
             [&](const Answer& one, const std::string& path) { draw_figure(one, path, common); });
    for (const std::string& line : answer.complaints) talk(line);
    return answer.code;
}

std::string figure_data(const Answer& answer) {
    if (!answer.figure) raise<UsageError>("the command draws no figure");
    const Figure figure = answer.figure();
    require_listed_figure(figure.name);
    return figure_text(figure, answer.provenance);
}

}  // namespace ripplenotch
