// SPDX-License-Identifier: MIT
#include "cli/export/written_file.hpp"

#include <filesystem>

#include "cli/talk.hpp"
#include "ripplenotch/core/files.hpp"

namespace ripplenotch {

void write_export(const Written& written, const CommonOptions& common, bool binary) {
    ByteSink sink(common.output, common.overwrite(), binary);
    sink.write(written.bytes);
    sink.finish();
    say_warnings(common, written.warnings);
}

ReadBack read_back(const Written& written, const CommonOptions& common) {
    const bool file = std::filesystem::is_regular_file(common.output);
    return {file ? read_all(common.output) : written.bytes,
            common.output == "-" ? "standard output" : common.output};
}

void tell_check(const std::string& text, const CommonOptions& common) {
    if (common.output != "-") {
        write_text("-", text, ByteSink::Overwrite::no);
    } else if (!common.quiet) {
        talk_lines(text);
    }
}

}  // namespace ripplenotch
