// SPDX-License-Identifier: MIT
// The front door: which format a log has, and which writer fits it.

#include <fmt/format.h>

#include <filesystem>

#include "log/clock/stamp.hpp"
#include "log/columns/derived_velocity.hpp"
#include "log/detect_format.hpp"
#include "log/read_on.hpp"
#include "log/unpack/unpacked_source.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {
namespace {

std::string clock_words(const Layout& layout) {
    if (!layout.chosen.time) return "none";
    const Column& column = layout.columns[*layout.chosen.time];
    return fmt::format("'{}' {}{}", column.name, layout.time_as_text ? "as text" : "in " + column.unit,
                       layout.time_fraction ? " and nanoseconds" : "");
}

// The range was put to the whole log; what is inside has to be read by the same clock.
void check_clock(const Layout& whole, const Layout& inside) {
    const std::string before = clock_words(whole), after = clock_words(inside);
    if (before == after) return;
    raise<DataError>(
        "{}: --from and --to: the time is read as {} in the whole log, as {} in the rows inside; say "
        "--columns time=NAME and --unit time=UNIT",
        whole.source, before, after);
}

/// Rows outside the range are gone before anything is decided about the others.
std::unique_ptr<LogReader> open_cut(const LogFormat& format, std::unique_ptr<ByteSource> source,
                                    std::string first_bytes, const ReadOptions& options) {
    if (format.cut == nullptr)
        raise<UsageError>("{}: --from and --to: rows of a log in format {} are read all or none",
                          source->name(), format.name);
    LogCut cut = format.cut(std::move(source), std::move(first_bytes), options);
    ReadOptions inside = options;
    inside.outside = cut.outside;
    auto reader = format.open(std::move(cut.bytes), {}, inside);
    const Layout& layout = reader->layout();
    check_clock(cut.whole, layout);
    if (layout.time_origin != cut.whole.time_origin) {
        cut.outside->zero_s =
            since(layout.time_origin, cut.whole.time_origin) * layout.columns[*layout.chosen.time].factor;
    }
    return reader;
}

std::string first_bytes_of(ByteSource& source) {
    std::string first_bytes;
    first_bytes.resize(read_on(source, first_bytes, 0, first_bytes_size));
    return first_bytes;
}

void require_built(const LogFormat& format, const std::string& source) {
    if (format.lacks.empty()) return;
    raise<UsageError>(
        "{}: read a log in format {}, and this build was made without {}; install it and build again", source,
        format.name, format.lacks);
}

}  // namespace

std::unique_ptr<LogReader> open_log(std::unique_ptr<ByteSource> source, const ReadOptions& options) {
    std::string first_bytes = first_bytes_of(*source);
    if (const Packing* const packing = packing_of(first_bytes)) {
        source = unpack(std::move(source), std::move(first_bytes), *packing);
        first_bytes = first_bytes_of(*source);
        if (packing_of(first_bytes) != nullptr) {
            raise<DataError>("{}: read a compressed file inside a {} file, expected a log; unpack it: {} {}",
                             source->name(), packing->name, packing->program, source->name());
        }
    }
    const LogFormat& format =
        options.format ? find_log_format(*options.format) : detect_format(first_bytes, source->name());
    require_built(format, source->name());
    auto reader = options.range.given() ? open_cut(format, std::move(source), std::move(first_bytes), options)
                                        : format.open(std::move(source), std::move(first_bytes), options);
    const Layout& layout = reader->layout();
    if (layout.velocity_from_position) return std::make_unique<DerivedVelocity>(std::move(reader));
    if (layout.constant_speed) {
        const DegPerSec speed = *layout.constant_speed;
        return std::make_unique<ConstantVelocity>(std::move(reader), speed);
    }
    return reader;
}

std::unique_ptr<LogReader> open_log(const std::string& path, const ReadOptions& options) {
    return open_log(std::make_unique<ByteSource>(path), options);
}

std::optional<double> estimated_rows(const std::string& path, const ReadOptions& options) {
    std::error_code failed;
    if (options.range.given() || !std::filesystem::is_regular_file(path, failed)) return std::nullopt;
    const auto size = static_cast<double>(std::filesystem::file_size(path, failed));
    const auto reader = open_log(path, options);
    RowBlock block;
    if (failed || !reader->next(block) || block.size() == 0) return std::nullopt;
    return size / (static_cast<double>(block.bytes.size()) / static_cast<double>(block.size()));
}

std::unique_ptr<LogWriter> rewrite_log(const std::string& path, const LogReader& reader,
                                       const LogFormat& format, const WriteOptions& options,
                                       ByteSink::Overwrite overwrite) {
    require_written(format, path);
    auto sink = std::make_unique<ByteSink>(path, overwrite, format.binary);
    const bool same = reader.layout().format == format.name && format.rewrite != nullptr;
    return same ? format.rewrite(std::move(sink), reader, options)
                : format.convert(std::move(sink), reader, options);
}

}  // namespace ripplenotch
