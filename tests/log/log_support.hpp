// SPDX-License-Identifier: MIT
#pragma once
// Logs from memory, in pieces of any size, and rewritten through a temporary file.

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch::test {

inline constexpr std::size_t whole = std::size_t(-1);

inline std::unique_ptr<ByteSource> in_memory(const std::string& bytes, std::size_t piece = whole) {
    return std::make_unique<ByteSource>("log.csv", std::make_shared<const std::string>(bytes), piece);
}

inline Log read_text(const std::string& bytes, const ReadOptions& options = {}, std::size_t piece = whole) {
    return read_log(in_memory(bytes, piece), options);
}

/// The message of the error that reading throws; empty when it reads.
inline std::string complaint(const std::string& bytes, const ReadOptions& options = {}) {
    try {
        read_text(bytes, options);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

inline ReadOptions with_columns(std::vector<std::string> columns) {
    ReadOptions options;
    options.columns = std::move(columns);
    return options;
}

/// A path in the temporary folder that is gone afterwards.
class TemporaryPath {
  public:
    explicit TemporaryPath(const std::string& extension = ".csv") {
        static int made = 0;
        path_ =
            std::filesystem::temp_directory_path() /
            ("ripplenotch-log-test-" + std::to_string(::getpid()) + "-" + std::to_string(made++) + extension);
    }
    ~TemporaryPath() {
        std::error_code ignored;
        std::filesystem::remove(path_, ignored);
    }
    TemporaryPath(const TemporaryPath&) = delete;
    TemporaryPath& operator=(const TemporaryPath&) = delete;
    [[nodiscard]] std::string string() const { return path_.string(); }

  private:
    std::filesystem::path path_;
};

/// Rows from memory, in blocks of any size.
class TraceReader final : public LogReader {
  public:
    explicit TraceReader(const Trace& trace, std::size_t block = 1000, std::optional<Hertz> stated = {})
        : trace_(trace), block_(block) {
        layout_.source = "log.csv";
        layout_.columns.resize(1);
        layout_.chosen.time = 0;
        layout_.stated_rate = stated;
    }
    [[nodiscard]] const Layout& layout() const override { return layout_; }
    bool next(RowBlock& block) override {
        block = RowBlock{};
        const std::size_t count = std::min(block_, trace_.size() - at_);
        const auto part = [&](const std::vector<double>& from) {
            const auto first = from.begin() + static_cast<std::ptrdiff_t>(at_);
            return from.empty() ? from
                                : std::vector<double>(first, first + static_cast<std::ptrdiff_t>(count));
        };
        block.first_row = at_;
        block.time_s = part(trace_.time_s);
        block.joints[0].velocity_deg_s = part(trace_.velocity_deg_s);
        block.joints[0].torque_nm = part(trace_.torque_nm);
        block.joints[0].position_deg = part(trace_.position_deg);
        at_ += count;
        return count > 0;
    }

  private:
    const Trace& trace_;
    std::size_t block_, at_ = 0;
    Layout layout_;
};

/// The trace as a log that is read.
inline Log read_trace(const Trace& trace, std::size_t block = 1000) {
    TraceReader reader(trace, block);
    ReadOptions options;
    options.needs_torque = false;
    return read_log(reader, options);
}

using TorqueMap = std::function<double(double)>;

/// The bytes of a log whose torque was mapped, written in `format` ("" for its own).
inline std::string rewritten(const std::string& bytes, const TorqueMap& map, const WriteOptions& write = {},
                             const ReadOptions& read = {}, const std::string& format = "",
                             std::size_t piece = whole) {
    const TemporaryPath out;
    const auto reader = open_log(in_memory(bytes, piece), read);
    const auto writer =
        rewrite_log(out.string(), *reader, find_log_format(format.empty() ? reader->layout().format : format),
                    write, ByteSink::Overwrite::yes);
    RowBlock block;
    std::vector<std::vector<double>> torque;
    while (reader->next(block)) {
        torque.resize(block.joints.size());
        for (std::size_t j = 0; j < torque.size(); ++j) {
            const std::vector<double>& raw = block.joints[j].torque_nm;
            torque[j].resize(raw.size());
            std::transform(raw.begin(), raw.end(), torque[j].begin(), map);
        }
        writer->write(block, torque);
    }
    writer->finish();
    return read_all(out.string());
}

inline std::string file_bytes(const std::string& path) { return read_all(path); }

inline double same(double torque) { return torque; }
inline double doubled(double torque) { return 2.0 * torque; }

inline std::string written(const LogFormat& format, const std::vector<NumberColumn>& columns) {
    const TemporaryPath path(std::string(format.extensions[0]));
    ByteSink sink(path.string(), ByteSink::Overwrite::yes, format.binary);
    format.write_columns(sink, columns);
    sink.finish();
    return file_bytes(path.string());
}

}  // namespace ripplenotch::test
