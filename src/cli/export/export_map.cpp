// SPDX-License-Identifier: MIT
#include "cli/export/export_map.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "cli/gear/joint_facts.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/output_name.hpp"
#include "ripplenotch/core/version.hpp"
#include "ripplenotch/document/map_json.hpp"
#include "ripplenotch/export/map_target.hpp"

namespace ripplenotch {
namespace {

std::string check_text(const std::string& file, const std::string& target, const LoadedMap& loaded,
                       const MapCheck& check) {
    return fmt::format(
        "{}: {}, read back and run at {} states in {}.\n"
        "ripple of the map       {:.4g} Nm rms\n"
        "no place in the target  {:.4g} Nm rms\n"
        "largest error           {:.2g} Nm\n",
        file, target, check.states, loaded.arithmetic, check.ripple_nm, check.not_held_nm,
        check.largest_error_nm);
}

}  // namespace

ExitCode export_map(const MapExport& request, const std::string& command_line) {
    if (request.common.json) raise<UsageError>("--json: of a map's export nothing is told as JSON yet");
    const Spec spec = parse_spec(request.to);
    const MapTarget& target = find_map_target(spec.name);
    check_output_name(request.common.output, target.name, target.endings);
    const Settings settings(fmt::format("target {}", spec.name), spec, target.keys);
    const RippleMap map = load_map(request.map).map;
    if (map.orders.empty()) raise<DataError>("{}: the map is empty: there is nothing to export", request.map);
    const InputRecord input = input_record(request.map);
    const std::vector<std::string> heading = {fmt::format("Made by {} {}:", tool_name, version()),
                                              command_line,
                                              fmt::format("from {}, SHA-256 {}", input.name, input.sha256)};
    const Written written = target.write(map, settings, heading);
    ByteSink sink(request.common.output, request.common.overwrite(), false);
    sink.write(written.bytes);
    sink.finish();
    say_warnings(request.common, written.warnings);
    if (!request.verify) return ExitCode::done;
    // The file that was written, not the text in memory; a pipe cannot be read again.
    const bool file = std::filesystem::is_regular_file(request.common.output);
    const std::string source = request.common.output == "-" ? "standard output" : request.common.output;
    const LoadedMap loaded =
        target.read(file ? read_all(request.common.output) : written.bytes, source, map, settings);
    const std::string text =
        check_text(source, std::string(target.name), loaded, verify_map_export(map, loaded));
    if (request.common.output != "-") {
        write_text("-", text, ByteSink::Overwrite::no);
    } else if (!request.common.quiet) {
        talk_lines(text);
    }
    return ExitCode::done;
}

}  // namespace ripplenotch
