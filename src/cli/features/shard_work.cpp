// SPDX-License-Identifier: MIT
#include "cli/features/shard_work.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "cli/features/feature_lines.hpp"
#include "core/process/two_cores.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/version.hpp"
#include "ripplenotch/document/features_json.hpp"
#include "ripplenotch/document/shard_json.hpp"

namespace ripplenotch {
namespace {

namespace fs = std::filesystem;

std::string sha256_of(std::string_view bytes) {
    Sha256 hash;
    hash.update(bytes);
    return hash.hex();
}

std::vector<std::string> record_names(const std::string& folder) {
    std::error_code failed;
    std::vector<std::string> names;
    for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed))
        if (at->path().filename().string().ends_with(record_ending)) names.push_back(at->path().string());
    if (failed) raise<FileError>("{}: {}", folder, failed.message());
    std::sort(names.begin(), names.end());
    return names;
}

// A record of the same shard that is there already, if its lines are as it says. One that is of another job
// is somebody else's work, and is not written over.
bool is_complete(const std::string& name, const ShardRecord& wanted, bool force) {
    if (!fs::exists(name)) return false;
    const ShardRecord found = shard_record_from_json(read_all(name), name);
    const std::string why = why_mixed(found, wanted);
    if (!why.empty() && force) return false;
    if (!why.empty())
        raise<DataError>("{} is of another job: {}; take another folder, or --force", name, why);
    try {
        static_cast<void>(lines_of_record(found, name));
        return true;
    } catch (const Error&) {
        return false;  // it is done again
    }
}

std::string without_option(std::string line, std::string_view option) {
    for (std::size_t at = 0; (at = line.find(option, at)) != std::string::npos;) {
        const std::size_t behind = at + option.size();
        const bool whole = at > 0 && line[at - 1] == ' ' && behind < line.size() &&
                           (line[behind] == ' ' || line[behind] == '=');
        if (!whole) {
            at = behind;
            continue;
        }
        // The value ends at the first blank outside of quotes.
        std::size_t end = behind + 1;
        for (bool quoted = false; end < line.size() && (quoted || line[end] != ' '); ++end)
            if (line[end] == '\'') quoted = !quoted;
        line.erase(at - 1, end - at + 1);
    }
    return line;
}

}  // namespace

// Neither where the work comes from nor how its lines may be called changes them.
std::string shard_settings(const std::string& command_line) {
    std::string settings = without_option(without_option(command_line, "--manifest"), "--shard") + " ";
    for (const std::string_view same : {" --json ", " --ndjson "})
        if (const std::size_t at = settings.find(same); at != std::string::npos)
            settings.erase(at, same.size() - 1);
    settings.pop_back();
    return settings;
}

std::string lines_of_record(const ShardRecord& record, const std::string& record_name) {
    const std::string name =
        record_name.substr(0, record_name.size() - record_ending.size()) + std::string(".ndjson");
    std::string lines = read_all(name);
    if (sha256_of(lines) != record.sha256)
        raise<DataError>("{}: its bytes are not those that {} tells of; do shard {}/{} again", name,
                         record_name, record.shard.number, record.shard.of);
    return lines;
}

ShardFolder read_shard_folders(const std::vector<std::string>& folders) {
    ShardFolder found;
    for (const std::string& folder : folders)
        for (const std::string& name : record_names(folder)) {
            found.records.push_back(shard_record_from_json(read_all(name), name));
            found.names.push_back(name);
        }
    return found;
}

void do_shard(const FeatureRequest& request, const FeatureWork& work, const Manifest& manifest,
              const std::string& settings) {
    ShardRecord record{
        std::string(version()), manifest.sha256, settings, shard_of(*request.shard), 0, 0, 0, {}};
    std::error_code failed;
    fs::create_directories(request.common.output, failed);
    if (failed) raise<FileError>("{}: {}", request.common.output, failed.message());
    const std::string folder = request.common.output + "/";
    const std::string record_name = folder + record_file_name(record.shard);
    if (is_complete(record_name, record, request.common.force)) {
        say(request.common, fmt::format("shard {} is complete already", *request.shard));
        return;
    }
    std::string text;
    const OneCore engine_has_the_others;
    for (const ManifestEntry& entry : part_of(manifest, record.shard)) {
        ++record.logs;
        for (const FeatureLine& line : feature_lines(entry, work)) {
            ++record.lines;
            if (line.failed()) {
                ++record.failed;
                say_warnings(request.common, std::vector{line.error});
            }
            text += feature_line_text(line);
        }
    }
    record.sha256 = sha256_of(text);
    // The lines first: a record is there only where its lines are.
    const ByteSink::Overwrite over{true, !request.common.no_sync};
    write_all(folder + shard_file_name(record.shard), text, over);
    write_all(record_name, shard_record_text(record), over);
}

}  // namespace ripplenotch
