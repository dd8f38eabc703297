// SPDX-License-Identifier: MIT
// Laws over the whole list of formats: a new one is tested the day it is listed.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <random>
#include <set>

#include "log/open.hpp"
#include "log_support.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"
#include "support/skipped.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;

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
        CHECK(format->open != nullptr);
        CHECK((format->rewrite == nullptr || format->is_written()));
        CHECK((format->convert == nullptr) == (format->write_columns == nullptr));
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
            } catch (const DataError& error) {
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
        } catch (const DataError& error) {
            REQUIRE(std::string(error.what()).size() < 2000);
            ++refused;
        } catch (const UsageError&) {
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
