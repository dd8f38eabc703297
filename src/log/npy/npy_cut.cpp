// SPDX-License-Identifier: MIT
#include "log/npy/npy_cut.hpp"

#include <fmt/format.h>

#include <cmath>

#include "log/npy/npy_reader.hpp"
#include "log/npy/temporary_bytes.hpp"
#include "log/row_cut.hpp"

namespace ripplenotch {
namespace {

class NpyCut : public ByteSource {
  public:
    NpyCut(NpyReader& whole, const ReadOptions& options)
        : ByteSource(Name{whole.layout().source}), cut_(options, whole.layout()) {
        cut_rows(whole);
        cut_.require_rows();
        const NpyHeader& header = whole.header();
        const std::string shape = header.structured
                                      ? fmt::format("{},", cut_.kept())
                                      : fmt::format("{}, {}", cut_.kept(), header.fields.size());
        head_ = make_npy_header(header.descr, shape, false);
        rows_.rewind();
    }

    std::size_t read(char* into, std::size_t size) override {
        if (given_ == head_.size()) return rows_.read(into, size);
        const std::size_t taken = head_.copy(into, size, given_);
        given_ += taken;
        return taken;
    }
    [[nodiscard]] std::size_t number_in_file(std::size_t number) const override {
        return numbers_.in_file(number);
    }
    [[nodiscard]] const RowCut& rows() const { return cut_; }

  private:
    void cut_rows(NpyReader& whole) {
        const std::size_t size = whole.header().record_size;
        const bool timed = whole.layout().chosen.time.has_value();
        RowBlock block;
        while (whole.fetch(block)) {
            const std::string_view bytes = block.bytes;
            for (std::size_t at = 0; at < bytes.size(); at += size) {
                std::optional<double> time;
                if (timed) time = whole.time_of(bytes.data() + at);
                const bool stays = cut_.keeps(time && std::isfinite(*time) ? time : std::nullopt);
                numbers_.add(stays);
                if (stays) rows_.put(bytes.substr(at, size));
            }
        }
    }

    RowCut cut_;
    KeptNumbers numbers_;
    TemporaryBytes rows_;
    std::string head_;
    std::size_t given_ = 0;  ///< of head_
};

}  // namespace

LogCut cut_npy(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options) {
    NpyReader whole(std::move(source), std::move(first_bytes), clock_only(options));
    auto bytes = std::make_unique<NpyCut>(whole, options);
    auto outside = bytes->rows().outside();
    return {std::move(bytes), whole.layout(), std::move(outside)};
}

}  // namespace ripplenotch
