// SPDX-License-Identifier: MIT
// A format that is read and not written: a record without writers is enough for one.
#include <array>

#include "log/open.hpp"
#include "log_support.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;
using Catch::Contains;

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
    [[nodiscard]] std::string_view head() const override { return {}; }
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
