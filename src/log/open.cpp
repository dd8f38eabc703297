// SPDX-License-Identifier: MIT
// The front door: which format a log has, which writer fits it, and rows as those of another format.

#include "log/open.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <utility>

#include "core/text/lower_case.hpp"
#include "log/columns/units.hpp"
#include "log/numbers/columns.hpp"
#include "log/unpack/unpacked_source.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/log/clock.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t most_bytes = std::size_t{8} << 20;

// Files that people hand over by mistake, told by their first bytes, and what to do with them. A format that
// is listed comes first, so that a file in this table can become one.
struct Stranger {
    std::string_view magic, what, remedy;
};
constexpr std::array strangers = {
    Stranger{"MDF     ", "an MDF file",
             "convert it: python3 -c \"import asammdf; asammdf.MDF('{}').export('csv', 'run.csv', "
             "single_time_base=True)\""},
    Stranger{"TDSm", "a TDMS file",
             "convert it: python3 -c \"import nptdms; "
             "nptdms.TdmsFile.read('{}').as_dataframe().to_csv('run.csv')\""},
    Stranger{"PAR1", "a Parquet file",
             "convert it: duckdb -c \"copy (from '{}') to 'run.csv' (format csv)\""},
    Stranger{"#ROSBAG", "a ROS 1 bag", "convert it: rosbags-convert --src {} --dst run"},
    Stranger{"BZh", "a bzip2 file", "unpack it: bzcat {} | ripplenotch ... -"},
    Stranger{"\xfd"
             "7zXZ",
             "an xz file", "unpack it: xzcat {} | ripplenotch ... -"},
    Stranger{"PK\x03\x04", "a ZIP archive (or .xlsx)",
             "unpack it, or convert a workbook: libreoffice --headless --convert-to csv {}"},
};

bool is_plain_name(const std::string& name) {
    constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._/+-";
    return !name.starts_with('-') && name.find_first_not_of(plain) == std::string::npos;
}

constexpr const LogFormat* const all_formats[] = {
#define FORMAT(name) &formats::name,
#include "log/formats/formats.def"
#undef FORMAT
};

/// ".csv .npy": one for each format that is written.
std::string written_extensions() {
    return joined(log_formats(), " ", [](const LogFormat* format) {
        return format->is_written() ? format->extensions.front() : "";
    });
}

/// As `asked`, or by the extension; null where neither says it.
const LogFormat* told_format(const std::string& path, std::optional<std::string_view> asked) {
    if (asked) return &find_log_format(*asked);
    const std::size_t dot = path.rfind('.');
    const std::string extension = dot == std::string::npos ? "" : lower_case(path.substr(dot));
    for (const LogFormat* format : log_formats()) {
        const auto& known = format->extensions;
        if (std::ranges::find(known, extension) != known.end()) return format;
    }
    check_output_name(path, "a log", written_extensions());
    return nullptr;
}

std::string first_bytes_of(ByteSource& source) {
    std::string first_bytes;
    read_on(source, first_bytes, first_bytes_size);
    return first_bytes;
}

void require_built(const LogFormat& format, const std::string& source) {
    if (format.lacks.empty()) return;
    raise<UsageError>(
        "{}: read a log in format {}, and this build was made without {}; install it and build again", source,
        format.name, format.lacks);
}

/// The rows of another reader with the shifts of their columns added, and a speed that was stated as the
/// velocity of all joints. Joints without a velocity get the slope of their position, where the layout says
/// so: central differences from row to row, one-sided at both ends of the log. A step of more than half a
/// turn is taken as a wrap.
class ChangedRows final : public LogReader {
  public:
    explicit ChangedRows(std::unique_ptr<LogReader> reader) : reader_(std::move(reader)) {
        const std::vector<JointColumns> joints =
            layout().velocity_from_position ? layout().all_chosen() : std::vector<JointColumns>();
        for (std::size_t j = 0; j < joints.size(); ++j) {
            if (joints[j].velocity || !joints[j].position) continue;
            const Column& position = layout().columns[*joints[j].position];
            joints_.push_back({j, 360.0 / position.motor_ratio.value_or(1.0), std::nullopt});
        }
    }

    [[nodiscard]] const Layout& layout() const override { return reader_->layout(); }
    [[nodiscard]] const LogReader& base() const override { return reader_->base(); }

    bool next(RowBlock& block) override {
        if (joints_.empty()) return read_stated(block);
        if (!std::exchange(begun_, true)) look_ahead();
        if (!more_) {
            if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
            return false;
        }
        std::swap(block, ahead_);
        look_ahead();
        for (Joint& joint : joints_)
            if (block.size() > 0) derive(block, joint);
        return true;
    }

  private:
    struct Point {
        double time_s = 0.0, position_deg = 0.0;
    };
    struct Joint {
        std::size_t place;
        double turn_deg;              ///< where the position would wrap
        std::optional<Point> before;  ///< the last row of the block before
    };
    // What is wrong in the block ahead must not keep the rows before it from being passed on.
    void look_ahead() {
        try {
            do {
                more_ = read_stated(ahead_);
            } while (more_ && ahead_.size() == 0 && ahead_.bytes.empty());
        } catch (...) {
            failure_ = std::current_exception();
            ahead_.clear();
            more_ = false;
        }
    }
    void derive(RowBlock& block, Joint& joint) const {
        const auto point = [&joint](const RowBlock& from, std::size_t row) {
            return Point{from.time_s[row], from.joints[joint.place].position_deg[row]};
        };
        const std::size_t size = block.size();
        double slope = 0.0;
        for (std::size_t i = 0; i < size; ++i) {
            const Point here = point(block, i);
            const Point first = i > 0 ? point(block, i - 1) : joint.before.value_or(here);
            const bool another = more_ && ahead_.size() > 0;
            const Point last = i + 1 < size ? point(block, i + 1) : another ? point(ahead_, 0) : here;
            const double passed = last.time_s - first.time_s;
            double moved = last.position_deg - first.position_deg;
            moved -= joint.turn_deg * std::round(moved / joint.turn_deg);
            if (passed > 0.0) slope = moved / passed;
            block.joints[joint.place].velocity_deg_s[i] = slope;
        }
        joint.before = point(block, size - 1);
    }

    bool read_stated(RowBlock& block) {
        if (!reader_->next(block)) return false;
        const std::vector<JointColumns> joints = layout().all_chosen();
        for (std::size_t j = 0; j < joints.size(); ++j) {
            JointRows& rows = block.joints[j];
            const auto shift = [this](std::optional<std::size_t> column, std::vector<double>& values) {
                const double by = column ? layout().columns[*column].shift : 0.0;
                for (double& value : values)
                    if (by != 0.0) value += by;
            };
            shift(joints[j].velocity, rows.velocity_deg_s);
            shift(joints[j].torque, rows.torque_nm);
            shift(joints[j].position, rows.position_deg);
            if (const auto speed = layout().constant_speed)
                rows.velocity_deg_s.assign(block.size(), speed->value());
        }
        return true;
    }

    std::unique_ptr<LogReader> reader_;
    std::vector<Joint> joints_;  ///< without a velocity of their own
    RowBlock ahead_;             ///< the block after the one that is passed on
    bool begun_ = false, more_ = false;
    std::exception_ptr failure_;  ///< of the block ahead; for when its turn comes
};

class Converter : public LogWriter {
  public:
    Converter(std::unique_ptr<ByteSink> sink, const LogReader& reader, const WriteOptions& options,
              const LogFormat& format)
        : sink_(std::move(sink)), append_(options.append) {
        const std::vector<JointColumns> joints = reader.layout().all_chosen();
        std::vector<std::string> names = {"time_s"};
        for (const JointColumns& joint : joints) {
            // One joint needs no name.
            const std::string prefix = joints.size() == 1 ? "" : joint.joint + "_";
            names.push_back(prefix + "velocity_deg_s");
            names.push_back(prefix + "torque_nm");
            has_position_.push_back(joint.position.has_value());
            if (joint.position) names.push_back(prefix + "position_deg");
            if (append_) names.push_back(prefix + options.append_name + "_nm");
        }
        table_ = format.table(*sink_, names, options);
    }

    void put(const RowBlock& block, Torques torque_nm, std::string_view /*bytes*/) override {
        std::vector<std::span<const double>> columns = {block.time_s};
        for (std::size_t j = 0; j < block.joints.size(); ++j) {
            const JointRows& joint = block.joints[j];
            columns.emplace_back(joint.velocity_deg_s);
            columns.emplace_back(append_ ? joint.torque_nm : torque_nm[j]);
            if (has_position_[j]) columns.emplace_back(joint.position_deg);
            if (append_) columns.emplace_back(torque_nm[j]);
        }
        table_->rows(columns);
    }

    void finish() override {
        table_->end();
        sink_->finish();
    }

  private:
    std::unique_ptr<ByteSink> sink_;
    std::unique_ptr<TableWriter> table_;
    bool append_;
    std::vector<bool> has_position_;
};

// "torque_filtered [Nm]" next to "tau [Nm]", "torque_filtered_Nm" next to "torque_Nm": a new column's name in
// the style of the torque column's.
std::string appended_name(const std::string& wanted, const std::string& torque_name) {
    const NameAndUnit parts = split_unit(torque_name, Role::torque);
    if (parts.unit.empty()) return wanted;
    // Whatever stands between the name and the unit stays: "_Nm", " [Nm]", "(Nm)".
    const std::size_t at = torque_name.rfind(parts.unit);
    const std::size_t from = torque_name.find(parts.name) + parts.name.size();
    return wanted + torque_name.substr(from, at - from) + torque_name.substr(at);
}

}  // namespace

Opening read_opening(LogReader& reader) {
    Opening opening;
    std::size_t bytes = 0;
    while (opening.time_s.size() < clock_rows && bytes < most_bytes) {
        RowBlock block;
        if (!reader.next(block)) {
            opening.whole_log = true;
            break;
        }
        std::size_t count = 0;
        while (count < block.size() && opening.time_s.size() + count < clock_rows &&
               (count >= block.row_end.size() || bytes + block.row_end[count] < most_bytes)) {
            ++count;
        }
        opening.time_s.insert(opening.time_s.end(), block.time_s.begin(),
                              block.time_s.begin() + static_cast<std::ptrdiff_t>(count));
        opening.counts.push_back(count);
        bytes += block.bytes.size();
        opening.blocks.push_back(std::move(block));
    }
    return opening;
}

bool next_block(Opening& opening, LogReader& reader, RowBlock& block) {
    if (opening.blocks.empty()) return reader.next(block);
    block = std::move(opening.blocks.front());
    opening.blocks.pop_front();
    return true;
}

const LogFormat& detect_format(std::string_view first_bytes, const std::string& source,
                               std::span<const LogFormat* const> formats) {
    std::vector<std::string_view> names;
    for (const LogFormat* format : formats) {
        if (format->sniff != nullptr && format->sniff(first_bytes)) return *format;
        names.push_back(format->name);
    }
    for (const Stranger& stranger : strangers) {
        if (!first_bytes.starts_with(stranger.magic)) continue;
        std::string remedy(stranger.remedy);
        // The line is there to be pasted: a name that a shell or Python would read otherwise does not go in.
        remedy.replace(remedy.find("{}"), 2, is_plain_name(source) ? source : "FILE");
        raise<DataError>("{}: read {}, expected a log as {}; {}", source, stranger.what,
                         fmt::join(names, " or "), remedy);
    }
    return formats::csv;
}

std::span<const LogFormat* const> log_formats() { return all_formats; }

std::vector<std::string> formats_not_built() {
    std::vector<std::string> missing;
    for (const LogFormat* format : log_formats())
        if (!format->lacks.empty()) missing.push_back(fmt::format("{} ({})", format->name, format->lacks));
    for (const Packing* packing : all_packings())
        if (!packing->lacks.empty()) missing.push_back(fmt::format("{} ({})", packing->name, packing->lacks));
    return missing;
}

const LogFormat& find_log_format(std::string_view name) {
    return find_entry(log_formats(), "log format", "formats", name);
}

std::string written_log_formats() {
    return joined(log_formats(), ", ",
                  [](const LogFormat* format) { return format->is_written() ? format->name : ""; });
}

void require_written(const LogFormat& format, const std::string& output) {
    if (format.is_written()) return;
    if (!format.lacks.empty()) {
        raise<UsageError>("{}: this build was made without {}, which writes {}; install it and build again",
                          output == "-" ? "standard output" : output, format.lacks, format.name);
    }
    raise<UsageError>("{}: format {} is read and not written; formats that are written: {}",
                      output == "-" ? "standard output" : output, format.name, written_log_formats());
}

const LogFormat& output_format(const std::string& path, std::optional<std::string_view> asked) {
    return output_format(path, asked, formats::csv);
}

const LogFormat& output_format(const std::string& path, std::optional<std::string_view> asked,
                               const LogFormat& log) {
    const LogFormat* told = told_format(path, asked);
    require_written(told != nullptr ? *told : log, path);
    return told != nullptr ? *told : formats::csv;
}

bool read_on(ByteSource& source, std::string& bytes, std::size_t size) {
    constexpr std::size_t first_room = std::size_t{1} << 12;
    std::size_t have = bytes.size();
    for (std::size_t got = 1; have < size && got > 0; have += got) {
        if (bytes.size() == have) bytes.resize(std::min(size, std::max(2 * have, first_room)));
        got = source.read(bytes.data() + have, std::min(size, bytes.size()) - have);
    }
    bytes.resize(have);
    return have < size;
}

std::unique_ptr<LogReader> open_log(std::unique_ptr<ByteSource> source, const ReadOptions& options) {
    if (!options.constant_speeds.empty())
        raise<UsageError>(
            "--constant-speed: read {} speeds for {}, expected one; identify takes several logs",
            options.constant_speeds.size(), source->name());
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
    auto reader =
        format.columns == nullptr
            ? format.open(std::move(source), std::move(first_bytes), options)
            : read_columns(format.columns(std::move(source), std::move(first_bytes), options), options);
    const Layout& layout = reader->layout();
    if (options.range.given() && !layout.outside)
        raise<UsageError>("{}: --from and --to: rows of a log in format {} are read all or none",
                          layout.source, format.name);
    const bool shifted =
        std::ranges::any_of(layout.columns, [](const Column& column) { return column.shift != 0.0; });
    if (shifted || layout.constant_speed || layout.velocity_from_position)
        return std::make_unique<ChangedRows>(std::move(reader));
    return reader;
}

std::unique_ptr<LogReader> open_log(const std::string& path, const ReadOptions& options) {
    return open_log(std::make_unique<ByteSource>(path), options);
}

std::unique_ptr<LogWriter> convert_rows(std::unique_ptr<ByteSink> sink, const LogReader& reader,
                                        const WriteOptions& options, const LogFormat& format) {
    return std::make_unique<Converter>(std::move(sink), reader, options, format);
}

void LogFormat::write_columns(ByteSink& sink, std::span<const NumberColumn> numbers) const {
    constexpr std::size_t rows_at_once = 16384;
    std::vector<std::string> names;
    for (const NumberColumn& column : numbers) {
        names.push_back(column.name);
        if (column.values.size() != numbers[0].values.size()) {
            throw std::invalid_argument("columns of a log differ in length: " + column.name);
        }
    }
    const auto writer = table(sink, names, {});
    const std::size_t rows = numbers.empty() ? 0 : numbers[0].values.size();
    Progress::current().begin("writing", "rows", rows);
    for (std::size_t first = 0; first < rows; first += rows_at_once) {
        std::vector<std::span<const double>> parts;
        for (const NumberColumn& column : numbers) {
            parts.push_back(std::span(column.values).subspan(first, std::min(rows_at_once, rows - first)));
        }
        writer->rows(parts);
        Progress::current().add(parts.front().size());
    }
    writer->end();
}

std::vector<std::string> appended_names(const Layout& layout, const WriteOptions& options) {
    std::vector<std::string> names;
    const auto taken = [&](const std::string& name) {
        return std::ranges::any_of(layout.columns, [&](const Column& column) { return column.name == name; });
    };
    for (const JointColumns& joint : layout.all_chosen()) {
        const std::string wanted =
            (layout.joints.size() < 2 ? "" : joint.joint + "_") + std::string(options.append_name);
        const std::string& torque = layout.columns[*joint.torque].name;
        names.push_back(appended_name(wanted, torque));
        for (int count = 2; taken(names.back()); ++count)
            names.back() = appended_name(fmt::format("{}_{}", wanted, count), torque);
    }
    return names;
}

std::unique_ptr<LogWriter> rewrite_log(const std::string& path, const LogReader& reader,
                                       const LogFormat& format, const WriteOptions& options,
                                       ByteSink::Overwrite overwrite) {
    require_written(format, path);
    auto sink = std::make_unique<ByteSink>(path, overwrite, format.binary);
    // The cells of a torque with an offset are not its multiples.
    const std::vector<JointColumns> joints = reader.layout().all_chosen();
    const bool shifted = std::ranges::any_of(joints, [&](const JointColumns& joint) {
        return joint.torque && reader.layout().columns[*joint.torque].shift != 0.0;
    });
    const bool same = reader.layout().format == format.name && format.rewrite != nullptr && !shifted;
    return same ? format.rewrite(std::move(sink), reader, options)
                : convert_rows(std::move(sink), reader, options, format);
}

}  // namespace ripplenotch
