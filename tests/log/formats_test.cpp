// SPDX-License-Identifier: MIT
// Laws of all formats, and arrays.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <random>
#include <set>
#include <string>

#include "log/npy/npy_header.hpp"
#include "log/open.hpp"
#include "log_support.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"
#include "support/skipped.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;
using Catch::Contains;

// Laws over the whole list of formats: a new one is tested the day it is listed.

namespace {

// Numbers of every size and sign, such as a text format could spoil.
std::vector<NumberColumn> table(std::size_t rows) {
    std::mt19937_64 random(11);
    std::vector<NumberColumn> columns = {
        {"time_s", {}}, {"velocity_deg_s", {}}, {"torque_nm", {}}, {"position_deg", {}}};
    for (std::size_t i = 0; i < rows; ++i) {
        const auto any = [&] {
            const double mantissa = std::ldexp(static_cast<double>(random() >> 11), -53) - 0.5;
            return std::ldexp(mantissa, static_cast<int>(random() % 120) - 60);
        };
        columns[0].values.push_back(92125.377 + static_cast<double>(i) * 0.001);
        for (std::size_t c = 1; c < 4; ++c) columns[c].values.push_back(any());
    }
    columns[2].values[0] = -0.0;
    columns[2].values[1] = 5e-324;
    columns[2].values[2] = 1e30;
    return columns;
}

// TMPDIR while it lives, where there is such a folder.
class TemporaryFilesIn {
  public:
    explicit TemporaryFilesIn(const char* folder) {
        if (const char* before = std::getenv("TMPDIR")) before_ = before;
        if (std::filesystem::is_directory(folder)) ::setenv("TMPDIR", folder, 1);
    }
    ~TemporaryFilesIn() { before_ ? ::setenv("TMPDIR", before_->c_str(), 1) : ::unsetenv("TMPDIR"); }
    TemporaryFilesIn(const TemporaryFilesIn&) = delete;
    TemporaryFilesIn& operator=(const TemporaryFilesIn&) = delete;

  private:
    std::optional<std::string> before_;
};

// Those that this build can read: all, where every library was there.
const std::vector<const LogFormat*>& built_formats() {
    static const std::vector<const LogFormat*> formats = [] {
        std::vector<const LogFormat*> found;
        for (const LogFormat* format : log_formats()) {
            // Examples of these are packed.
            const bool packed = format->name == "npz" || format->name == "mcap";
            if (format->lacks.empty() && !(packed && !formats_not_built().empty()))
                found.push_back(format);
            else
                skipped(std::string(format->name) + ": this build lacks a library");
        }
        return found;
    }();
    return formats;
}

const std::vector<const LogFormat*>& written_formats() {
    static const std::vector<const LogFormat*> formats = [] {
        std::vector<const LogFormat*> found;
        for (const LogFormat* format : log_formats()) {
            if (format->is_written()) found.push_back(format);
        }
        return found;
    }();
    return formats;
}

// Numbers of any size are no joint's: nobody has to find out which side of the gear they are from.
ReadOptions of_the_joint() {
    ReadOptions options;
    options.sides = {{Role::velocity, Shaft::joint}, {Role::position, Shaft::joint}};
    return options;
}

std::string law_path(std::string_view extension) {
    return source_folder() + "/tests/log/data/law" + std::string(extension);
}

// An example of every format: what it writes, or where it writes nothing the file that came with it.
std::string example(const LogFormat& format, std::size_t rows) {
    return format.is_written() ? written(format, table(rows)) : file_bytes(law_path(format.extensions[0]));
}

// How the example is read: of what is told, as it was made.
ReadOptions options_of(const LogFormat& format, ReadOptions options = {}) {
    if (!format.told) return options;
    options.format = std::string(format.name);
    options.records = "f8:time_s,f8:velocity_deg_s,f8:torque_nm,f8:position_deg";
    return options;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

}  // namespace

TEST_CASE("formats have names, extensions and summaries of their own", "[log]") {
    std::set<std::string_view> names, extensions;
    for (const LogFormat* format : log_formats()) {
        CHECK(names.insert(format->name).second);
        CHECK_FALSE(format->summary.empty());
        CHECK_FALSE(format->extensions.empty());
        for (const auto extension : format->extensions) CHECK(extensions.insert(extension).second);
        CHECK(&find_log_format(format->name) == format);
        CHECK((format->rewrite == nullptr || format->is_written()));
        CHECK((format->open == nullptr) == (format->columns != nullptr || !format->lacks.empty()));
        CHECK((format->sniff == nullptr) == (format->name == "csv"));
        const std::string named = "log" + std::string(format->extensions[0]);
        if (format->is_written()) {
            CHECK(&output_format(named, std::nullopt) == format);
            CHECK(&output_format("x.unknown", format->name) == format);
        } else {
            CHECK_THROWS_WITH(output_format(named, std::nullopt), Catch::Contains(written_log_formats()));
            CHECK_THROWS_WITH(output_format("x.unknown", format->name),
                              Catch::Contains(written_log_formats()));
        }
    }
    CHECK(output_format("-", std::nullopt).name == "csv");
    CHECK(output_format("a.b/log", std::nullopt).name == "csv");
    CHECK_THROWS_WITH(find_log_format("xls"), Catch::Contains("csv"));
}

TEST_CASE("a format that is only read comes with an example, which reads as its twin in CSV", "[log]") {
    for (const LogFormat* format : built_formats()) {
        if (format->is_written()) continue;
        // What has stamps has a twin with stamps.
        const std::string own_twin = law_path(std::string(format->extensions[0]) + ".csv");
        const Log twin =
            read_text(file_bytes(std::filesystem::exists(own_twin) ? own_twin : law_path(".csv")));
        CHECK(twin.trace.size() == 64);
        const std::string path = law_path(format->extensions[0]);
        INFO(format->name << ": tests/log/data/law" << format->extensions[0]);
        REQUIRE(std::filesystem::is_regular_file(path));
        const Log log = read_text(file_bytes(path), options_of(*format));
        CHECK(log.layout.format == format->name);
        CHECK(same_bits(log.trace.time_s, twin.trace.time_s));
        CHECK(same_bits(log.trace.velocity_deg_s, twin.trace.velocity_deg_s));
        CHECK(same_bits(log.trace.torque_nm, twin.trace.torque_nm));
        CHECK(same_bits(log.trace.position_deg, twin.trace.position_deg));
    }
}

TEST_CASE("what a format writes it reads back bit for bit", "[log]") {
    for (const LogFormat* format : written_formats()) {
        INFO(format->name);
        const auto columns = table(3000);
        const std::string bytes = written(*format, columns);
        CHECK(bytes == written(*format, columns));
        const Log log = read_text(bytes, of_the_joint());
        CHECK(log.layout.format == format->name);
        CHECK(same_bits(log.trace.time_s, columns[0].values));
        CHECK(same_bits(log.trace.velocity_deg_s, columns[1].values));
        CHECK(same_bits(log.trace.torque_nm, columns[2].values));
        std::vector<double> position_deg;  // as it stands there: these numbers are no joint's
        RowBlock block;
        const auto reader = open_log(in_memory(bytes), of_the_joint());
        while (reader->next(block)) {
            const auto& rows = block.joints[0].position_deg;
            position_deg.insert(position_deg.end(), rows.begin(), rows.end());
        }
        CHECK(same_bits(position_deg, columns[3].values));
        CHECK(rewritten(
                  bytes, [](double torque) { return torque; }, {}, of_the_joint()) == bytes);
    }
}

TEST_CASE("exactly one format claims the bytes of a format, whatever the order of the list", "[log]") {
    for (const LogFormat* format : built_formats()) {
        INFO(format->name);
        const std::string bytes = example(*format, 5).substr(0, first_bytes_size);
        for (const LogFormat* other : log_formats()) {
            if (other->sniff != nullptr) CHECK(other->sniff(bytes) == (other == format && !format->told));
        }
        if (!format->told) CHECK(&detect_format(bytes, "log") == format);
    }
}

TEST_CASE("where the bytes are cut into pieces does not matter", "[log]") {
    for (const LogFormat* format : built_formats()) {
        const std::string bytes = example(*format, 3000);
        const ReadOptions options = options_of(*format, of_the_joint());
        const Log log = read_text(bytes, options);
        for (const std::size_t piece :
             {std::size_t{1}, std::size_t{7}, std::size_t{4096}, std::size_t{65536}}) {
            INFO(format->name << " in pieces of " << piece);
            const Log again = read_text(bytes, options, piece);
            CHECK(same_bits(again.trace.torque_nm, log.trace.torque_nm));
            CHECK(same_bits(again.trace.time_s, log.trace.time_s));
            if (!format->is_written()) continue;
            CHECK(rewritten(
                      bytes, [](double t) { return 2 * t; }, {}, of_the_joint(), "", piece) ==
                  rewritten(
                      bytes, [](double t) { return 2 * t; }, {}, of_the_joint()));
        }
    }
}

TEST_CASE("every beginning of a good file reads or is refused, and what is read was there", "[log]") {
    // Thousands of small files: on a disk most of the time is its journal's.
    const TemporaryFilesIn memory("/dev/shm");
    for (const LogFormat* format : built_formats()) {
        INFO(format->name);
        const std::string bytes = example(*format, 12);
        const Log all = read_text(bytes, options_of(*format));
        std::size_t tried = 0, refused = 0;
        for (std::size_t length = 0; length < bytes.size(); ++length) {
            ++tried;
            try {
                const Log log = read_text(bytes.substr(0, length), options_of(*format));
                REQUIRE(log.trace.size() <= all.trace.size());
                // The last number of a text may be cut inside its digits; nobody can tell. All others are
                // right.
                for (std::size_t i = 0; i + 1 < log.trace.size(); ++i)
                    REQUIRE(log.trace.torque_nm[i] == all.trace.torque_nm[i]);
            } catch (const Error& error) {
                REQUIRE(std::string(error.what()).rfind("log.csv", 0) == 0);
                ++refused;
            }
        }
        if (format->is_written()) CHECK(refused > tried / 2);
    }
}

TEST_CASE("damaged bytes are read or refused with a message, never worse", "[log]") {
    std::mt19937_64 random(5);
    std::vector<std::string> seeds;
    for (const LogFormat* format : built_formats()) seeds.push_back(example(*format, 12));
    for (const std::string folder : {"/data/dialects", "/tests/log/data"}) {
        for (const auto& entry : std::filesystem::directory_iterator(source_folder() + folder))
            seeds.push_back(file_bytes(entry.path().string()));
    }
    const std::string telling = ",;\t \"\n\r.-+eE#%/0[]()'{}\\\x93";
    ReadOptions lenient;
    lenient.needs_torque = false;
    std::size_t read = 0, refused = 0;
    const std::size_t rounds = 6000;
    for (std::size_t round = 0; round < rounds; ++round) {
        std::string bytes = seeds[random() % seeds.size()];
        for (std::uint64_t k = random() % 6 + 1; k > 0 && !bytes.empty(); --k) {
            const std::size_t at = random() % bytes.size();
            switch (random() % 5) {
                case 0:
                    bytes[at] = static_cast<char>(random());
                    break;
                case 1:
                    bytes[at] = telling[random() % telling.size()];
                    break;
                case 2:
                    bytes.erase(at, random() % 9 + 1);
                    break;
                case 3:
                    bytes.insert(at, 1, telling[random() % telling.size()]);
                    break;
                default:
                    bytes.insert(at, bytes.substr(random() % bytes.size(), random() % 40));
                    break;
            }
        }
        try {
            const Log log =
                read_text(bytes, round % 2 == 0 ? ReadOptions{} : lenient, round % 3 == 0 ? 5 : whole);
            REQUIRE(log.trace.time_s.size() == log.trace.torque_nm.size());
            REQUIRE(log.trace.velocity_deg_s.size() == log.trace.torque_nm.size());
            ++read;
        } catch (const Error& error) {
            REQUIRE(std::string(error.what()).size() < 2000);
            ++refused;
        }
    }
    CHECK(read > rounds / 60);
    CHECK(refused > rounds / 6);
}

TEST_CASE("pure noise is refused", "[log]") {
    std::mt19937_64 random(9);
    for (int round = 0; round < 300; ++round) {
        std::string bytes(random() % 3000, '\0');
        for (char& byte : bytes) byte = static_cast<char>(random());
        CHECK_THROWS_AS(read_text(bytes), DataError);
    }
}

TEST_CASE("a growing array is finished in a file and through a pipe alike", "[log]") {
    const LogFormat& npy = find_log_format("npy");
    for (const std::size_t rows : {std::size_t{3}, std::size_t{40000}}) {
        const std::string bytes = written(npy, table(rows));
        CHECK(bytes.find("(" + std::to_string(rows) + ",)") != std::string::npos);
    }
}

// NumPy files, against files that NumPy 1.24.2 wrote.

namespace {

std::string reference(const std::string& name) {
    return file_bytes(source_folder() + "/tests/log/data/" + name);
}

}  // namespace

TEST_CASE("arrays that NumPy wrote hold the rows that were put in", "[log]") {
    const std::vector<double> torque = {2.5, -0.25, 100, 0.125, -3};
    for (const std::string name :
         {"structured_f8.npy", "structured_f8_v2.npy", "structured_f8_v3.npy", "structured_big_endian_f4.npy",
          "structured_mixed.npy", "structured_aligned.npy", "plain_f8.npy", "plain_f4_three.npy"}) {
        INFO(name);
        for (const std::size_t piece : {whole, std::size_t{1}}) {
            const Log log = read_text(reference(name), {}, piece);
            CHECK(log.layout.format == "npy");
            CHECK(log.trace.torque_nm == torque);
            CHECK(log.trace.velocity_deg_s == std::vector<double>{10, 11, 12, 13, 14});
            CHECK(log.trace.time_s[4] == Approx(0.04).epsilon(1e-6));
            if (log.trace.view().has_position())
                CHECK(log.trace.position_deg[1] == Approx(0.1).epsilon(1e-6));
        }
    }
}

TEST_CASE("joints in an array column are told apart", "[log]") {
    ReadOptions options;
    CHECK_THAT(complaint(reference("structured_two_joints.npy")), Contains("2 joints (0, 1)"));
    options.joint = "j1";
    CHECK(read_text(reference("structured_two_joints.npy"), options).trace.torque_nm[4] == -3.0);
    options.joint = "0";
    CHECK(read_text(reference("structured_two_joints.npy"), options).trace.torque_nm[4] == 3.0);
}

TEST_CASE("a plain array is taken by place, with a warning, or as told", "[log]") {
    CHECK_THAT(read_text(reference("plain_f8.npy")).layout.warnings.at(0).text,
               Contains("time, velocity, torque, position by place"));
    const auto told = with_columns({"position", "-", "torque", "velocity"});
    ReadOptions options = told;
    options.sample_rate = Hertz(100.0);
    options.units = {{"velocity", "deg/s"}, {"torque", "Nm"}, {"position", "deg"}};
    const Log log = read_text(reference("plain_f8.npy"), options);
    CHECK(log.trace.velocity_deg_s[1] == 0.1);
    CHECK(log.trace.position_deg[1] == 0.01);
}

TEST_CASE("an array whose unit is looked for far ahead still comes in small blocks", "[log]") {
    constexpr std::size_t rows = 400'000, largest_block = std::size_t{1} << 18;  // 9.6 MB
    std::vector<double> numbers;
    for (std::size_t k = 0; k < rows; ++k)
        numbers.insert(numbers.end(), {0.001 * static_cast<double>(k), 50.0, static_cast<double>(k)});
    const std::string file =
        make_npy_header("'<f8'", std::to_string(rows) + ", 3", false) +
        std::string(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double));
    const auto reader = open_log(in_memory(file), {});
    RowBlock block;
    std::size_t row = 0;
    while (reader->next(block)) {
        CHECK(block.bytes.size() <= largest_block);
        for (const double torque : block.joints[0].torque_nm)
            if (torque != static_cast<double>(row++)) FAIL("row " << row - 1 << " has " << torque);
    }
    CHECK(row == rows);
    CHECK_THAT(complaint(file + "abc"), Contains("more bytes after the 400000 rows"));
    CHECK_THAT(complaint(file.substr(0, file.size() - 1)), Contains("a part of one"));
}

TEST_CASE("an array in Fortran order, or with a row a signal, is the same log", "[log]") {
    const Log plain = read_text(reference("plain_f8.npy"));
    const Log fortran = read_text(reference("plain_fortran.npy"));
    CHECK(fortran.trace.time_s == plain.trace.time_s);
    CHECK(fortran.trace.velocity_deg_s == plain.trace.velocity_deg_s);
    CHECK(fortran.trace.torque_nm == plain.trace.torque_nm);
    CHECK(fortran.trace.position_deg == plain.trace.position_deg);
    std::string cut = reference("plain_fortran.npy");
    cut.resize(cut.size() - 1);
    CHECK_THAT(complaint(cut), Contains("cut off"));
}

TEST_CASE("arrays that are no log are refused with the remedy", "[log]") {
    CHECK_THAT(complaint(reference("refused_objects.npy")), Contains("Python objects"));
    CHECK_THAT(complaint(reference("refused_three_dimensions.npy")), Contains("3 dimensions"));
    CHECK_THAT(complaint(reference("refused_text.npy")), Contains("no column of numbers"));
    CHECK_THAT(complaint(reference("refused_empty.npy")), Contains("without rows"));
    CHECK_THAT(complaint(reference("plain_f8.npy") + "x"), Contains("more bytes after the 5 rows"));
    std::string cut = reference("plain_f8.npy");
    cut.resize(cut.size() - 1);
    CHECK_THAT(complaint(cut), Contains("cut off"));
    std::string future = reference("plain_f8.npy");
    future[6] = 9;
    CHECK_THAT(complaint(future), Contains("version 9"));
    std::string bad = reference("structured_f8.npy");
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::memcpy(bad.data() + bad.size() - 16, &nan, 8);
    CHECK_THAT(complaint(bad), Contains("row 5, 'torque_Nm' (column 3): read nan, expected a finite number"));
    ReadOptions options;
    options.hold_bad_values = true;
    CHECK(read_text(bad, options).trace.torque_nm[4] == 0.125);
}

TEST_CASE("an array is rewritten with other torques and nothing else changed", "[log]") {
    for (const std::string name :
         {"structured_f8.npy", "structured_f8_v2.npy", "structured_big_endian_f4.npy",
          "structured_aligned.npy", "plain_f8.npy", "plain_f4_three.npy"}) {
        INFO(name);
        const std::string bytes = reference(name);
        CHECK(rewritten(bytes, same) == bytes);
        const std::string twice = rewritten(bytes, doubled);
        CHECK(twice.size() == bytes.size());
        CHECK(read_text(twice).trace.torque_nm == std::vector<double>{5, -0.5, 200, 0.25, -6});
        CHECK(rewritten(twice, [](double torque) { return 0.5 * torque; }) == bytes);
        WriteOptions append;
        append.append = true;
        const std::string wider = rewritten(bytes, doubled, append);
        CHECK(npy_header_size(wider) % 64 == 0);
        if (name.find("plain") == std::string::npos) {
            CHECK(read_text(wider).trace.torque_nm == read_text(bytes).trace.torque_nm);
            CHECK(read_text(wider, with_columns({"torque=torque_filtered_Nm"})).trace.torque_nm ==
                  read_text(twice).trace.torque_nm);
        }
    }
    CHECK_THROWS_WITH(rewritten(reference("structured_mixed.npy"), doubled),
                      Contains("integers") && Contains("--append"));
}

TEST_CASE("a damaged header is refused and never more memory than the file deserves is taken", "[log]") {
    const auto header = [](const std::string& dictionary) {
        std::string text = dictionary;
        text.resize(118, ' ');
        return std::string("\x93NUMPY\x01\x00\x76\x00", 10) + text;
    };
    for (const std::string dictionary :
         {"{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999999999999, 3), }",
          "{'descr': '<f8', 'fortran_order': False, 'shape': (4611686018427387904, 3), }",
          "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 999999999), }",
          "{'descr': '<f99999999999999999', 'fortran_order': False, 'shape': (3, 3), }",
          "{'descr': [('a', '<f8', (99999999, 99999999))], 'shape': (3,), }",
          "{'descr': [('a', [('b', '<f8')])], 'shape': (3,), }", "{'descr': '<f8'", "{", "", "{'descr': [(",
          "{'x': 1}", "{'descr': '', 'shape': (1,3)}", "{'shape': (1,3)}", "{'descr': '<f8', 'shape': ()}"}) {
        INFO(dictionary);
        CHECK_FALSE(complaint(header(dictionary)).empty());
    }
}

// A format that is read and not written: a record without writers is enough for one.

namespace {

// Its magic is that of files which are refused while no format knows them.
constexpr std::string_view magic = "TDSm";
constexpr std::array<std::string_view, 1> extensions = {".tdms"};

class TrialReader final : public LogReader {
  public:
    explicit TrialReader(std::unique_ptr<LogReader> text) : text_(std::move(text)), layout_(text_->layout()) {
        layout_.format = "trial";
    }
    [[nodiscard]] const Layout& layout() const override { return layout_; }
    bool next(RowBlock& block) override { return text_->next(block); }

  private:
    std::unique_ptr<LogReader> text_;
    Layout layout_;
};

// Text behind the magic.
std::unique_ptr<LogReader> open_trial(std::unique_ptr<ByteSource> source, std::string first_bytes,
                                      const ReadOptions& options) {
    std::array<char, 64> piece{};
    while (const std::size_t got = source->read(piece.data(), piece.size()))
        first_bytes.append(piece.data(), got);
    return std::make_unique<TrialReader>(open_log(in_memory(first_bytes.substr(magic.size())), options));
}

constexpr LogFormat trial{
    .name = "trial",
    .summary = "what a trial writes",
    .extensions = extensions,
    .binary = true,
    .sniff = [](std::string_view first_bytes) { return first_bytes.starts_with(magic); },
    .open = open_trial,
};

std::string trial_bytes() {
    return std::string(magic) + "time_s,velocity_deg_s,torque_nm\n0,1,1.5\n1,1,2.5\n2,1,3.5\n";
}

}  // namespace

TEST_CASE("every listed format is asked before foreign bytes are refused", "[log]") {
    CHECK_THROWS_WITH(detect_format(magic, "run.tdms"),
                      Contains("run.tdms: read a TDMS file, expected a log as"));
    for (const LogFormat* format : log_formats())
        CHECK_THROWS_WITH(detect_format(magic, "run.tdms"), Contains(std::string(format->name)));
    std::vector<const LogFormat*> formats(log_formats().begin(), log_formats().end());
    formats.push_back(&trial);
    CHECK(&detect_format(magic, "run.tdms", formats) == &trial);
    CHECK(detect_format("time_s,velocity_deg_s", "run.csv", formats).name == "csv");
    CHECK(detect_format("", "empty", formats).name == "csv");
}

TEST_CASE("a log in a format that is only read is converted to one that is written", "[log]") {
    const auto reader = trial.open(in_memory(trial_bytes(), 7), {}, {});
    const TemporaryPath out;
    const auto writer = rewrite_log(out.string(), *reader, output_format(out.string(), std::nullopt, trial),
                                    {}, ByteSink::Overwrite::yes);
    RowBlock block;
    while (reader->next(block)) writer->write(block, {&block.joints[0].torque_nm, 1});
    writer->finish();
    CHECK(file_bytes(out.string()) == "time_s,velocity_deg_s,torque_nm\n0,1,1.5\n1,1,2.5\n2,1,3.5\n");
}

TEST_CASE("nothing is written in a format that is only read, in one line that says what can be", "[log]") {
    CHECK_FALSE(trial.is_written());
    const std::string refusal =
        "format trial is read and not written; formats that are written: csv, npy, mat";
    CHECK_THROWS_WITH(output_format("-", std::nullopt, trial), Contains("standard output: " + refusal));
    CHECK_THROWS_WITH(output_format("run.xyz", std::nullopt, trial), Contains("run.xyz: " + refusal));
    CHECK(output_format("-", "npy", trial).name == "npy");
    CHECK(output_format("run.csv", std::nullopt, trial).name == "csv");
    const auto reader = trial.open(in_memory(trial_bytes()), {}, {});
    const TemporaryPath out;
    CHECK_THROWS_WITH(rewrite_log(out.string(), *reader, trial, {}, ByteSink::Overwrite::yes),
                      Contains(refusal));
    CHECK_FALSE(std::filesystem::exists(out.string()));
}
