// SPDX-License-Identifier: MIT
// The options that every command with a log shares: what is declared, and what it asks of the reader.
#include <fmt/format.h>

#include <string>

#include "cli/options/name_list.hpp"
#include "cli/options/number_list.hpp"
#include "cli/options/options.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

void attach_log(Options& options, LogOptions& log) {
    options.text("--format", log.format, "NAME",
                 fmt::format("format of the log: {} (default: found out from its first bytes)",
                             name_list(log_formats())));
    options.quantity("--sample-rate", log.sample_rate, Dimension::frequency,
                     "rate of a log without time; overrides the log's own time");
    attach_log_columns(options, log);
}

void attach_log_columns(Options& options, LogOptions& log) {
    options.text(
        "--from", log.from, "TIME",
        "rows before are as if they were not there: 2s, 500ms, 1.5min or 1:30 on the log's own time axis; "
        "12:30:05 where it has times of day");
    options.text("--to", log.to, "TIME", "rows after are as if they were not there; the row at TIME counts");
    options.text("--joint", log.joint, "NAME",
                 "which joint of a file that holds several; all runs each where possible");
    options.text(
        "--columns", log.columns, "LIST",
        "what the columns are: by place 'time,velocity,torque' (- skips one), or by name 'torque=tau_J'");
    options.texts("--unit", log.units, "COLUMN=UNIT",
                  "unit of a column: velocity=rad/s, torque=mNm, time=ms; repeatable");
    options.text("--side", log.side, "SIDE",
                 "where motion is measured: motor (before the gear) or joint; or by column, velocity=motor");
    options.quantity("--constant-speed", log.constant_speed, Dimension::speed,
                     "of the joint (of the motor with --side motor), throughout a log that holds no motion: "
                     "60rpm");
    options.text("--delimiter", log.delimiter, "CHAR", "between cells of a text log: , ; space or tab");
    options.text("--decimal", log.decimal, "MARK", "decimal mark of a text log: . or ,");
    options.flag("--no-header", log.no_header, "the first row of a text log is data");
    options.count("--skip-lines", log.skip_lines, 0, 1000000,
                  "lines at the top of a text log that are not read");
    options.text(
        "--layout", log.records, "FIELDS",
        "of a record of a raw dump (--format raw): 'f8:time_s,f4:velocity_deg_s,<i2*0.01:torque_nm'");
    options.count("--skip-bytes", log.skip_bytes, 0, 1 << 30, "bytes before the first record of a raw dump");
    options.text("--clock", log.clock, "CLOCK",
                 "of recorded messages: header (their own stamps, the default where they have them) or log "
                 "(when they were recorded)");
    options.text(
        "--join", log.join, "HOW",
        "of signals of several topics, which --columns names: linear (the default), hold or nearest");
    options.text("--kt", log.kt, "Nm/A", "torque constant, for logs of motor current");
    options.flag("--hold-bad-values", log.hold_bad_values,
                 "replace empty cells and nan by the value before, and count them");
}

namespace {

// A path into a container may hold commas: "torque=log.tau(:,3)".
std::vector<std::string> split_outside_brackets(const std::string& text) {
    std::vector<std::string> pieces;
    int depth = 0;
    for (const std::string& piece : split_commas(text)) {
        if (depth > 0)
            pieces.back() += "," + piece;
        else
            pieces.push_back(piece);
        for (const char c : piece) depth += c == '(' || c == '[' ? 1 : c == ')' || c == ']' ? -1 : 0;
    }
    return pieces;
}

// "motor", "velocity=motor,position=joint"
std::map<Role, Shaft> read_sides(const std::string& text) {
    std::map<Role, Shaft> sides;
    for (const std::string& piece : split_commas(text)) {
        const std::size_t equals = piece.find('=');
        const std::string role = equals == std::string::npos ? "" : piece.substr(0, equals);
        const std::string side = equals == std::string::npos ? piece : piece.substr(equals + 1);
        const bool known_role = role.empty() || role == "velocity" || role == "position";
        if (!known_role || (side != "motor" && side != "joint"))
            raise<UsageError>("--side: '{}' is none of motor, joint, velocity=motor, position=motor", piece);
        const Shaft shaft = side == "motor" ? Shaft::motor : Shaft::joint;
        if (role != "position") sides[Role::velocity] = shaft;
        if (role != "velocity") sides[Role::position] = shaft;
    }
    return sides;
}

}  // namespace

ReadOptions LogOptions::resolve() const {
    ReadOptions read;
    read.format = format;
    read.joint = joint;
    if (columns) read.columns = split_outside_brackets(*columns);
    for (const std::string& entry : units) {
        for (const std::string& piece : split_commas(entry)) {
            const std::size_t equals = piece.find('=');
            if (equals == std::string::npos || equals == 0 || equals + 1 == piece.size()) {
                raise<UsageError>("--unit: '{}' is not COLUMN=UNIT, for example velocity=rad/s", piece);
            }
            read.units[piece.substr(0, equals)] = piece.substr(equals + 1);
        }
    }
    if (from) read.range.from = parse_time_point(*from, "--from");
    if (to) read.range.to = parse_time_point(*to, "--to");
    read.sample_rate = sample_rate;
    if (sample_rate && !(sample_rate->value() > 0.0)) raise<UsageError>("--sample-rate: must be above 0 Hz");
    read.constant_speed = constant_speed;
    const auto one_character = [](const std::string& text, std::string_view option) {
        if (text == "space") return ' ';
        if (text == "tab" || text == "\\t") return '\t';
        if (text.size() != 1) raise<UsageError>("{}: '{}' is not one character", option, text);
        return text.front();
    };
    if (delimiter) read.delimiter = one_character(*delimiter, "--delimiter");
    if (decimal) {
        read.decimal_mark = one_character(*decimal, "--decimal");
        if (*read.decimal_mark != '.' && *read.decimal_mark != ',') {
            raise<UsageError>("--decimal: '{}' is neither . nor ,", *decimal);
        }
    }
    if (no_header) read.header = false;
    if (kt) {
        std::string text = *kt;
        if (text.size() > 4 && text.compare(text.size() - 4, 4, "Nm/A") == 0) text.resize(text.size() - 4);
        read.nm_per_ampere = parse_quantity(text, Dimension::none, "--kt");
    }
    read.hold_bad_values = hold_bad_values;
    if (clock && *clock != "log" && *clock != "header")
        raise<UsageError>("--clock: '{}' is none of header, log", *clock);
    read.clock = clock;
    if (join && *join != "nearest" && *join != "hold" && *join != "linear")
        raise<UsageError>("--join: '{}' is none of nearest, hold, linear", *join);
    read.join = join;
    read.records = records;
    read.skip_bytes = static_cast<std::uint64_t>(skip_bytes);
    read.skip_lines = static_cast<std::size_t>(skip_lines);
    if (side) read.sides = read_sides(*side);
    return read;
}

}  // namespace ripplenotch
