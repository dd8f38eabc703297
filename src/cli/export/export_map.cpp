// SPDX-License-Identifier: MIT
#include "cli/export/export_map.hpp"

#include <fmt/format.h>

#include "cli/export/written_file.hpp"
#include "cli/gear/joint_facts.hpp"
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
    write_export(written, request.common);
    if (!request.verify) return ExitCode::done;
    const ReadBack again = read_back(written, request.common);
    const LoadedMap loaded = target.read(again.bytes, again.source, map, settings);
    tell_check(check_text(again.source, std::string(target.name), loaded, verify_map_export(map, loaded)),
               request.common);
    return ExitCode::done;
}

}  // namespace ripplenotch
