// SPDX-License-Identifier: MIT
#include "log/records/joined_records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>

#include "log/npy/npy_reader.hpp"
#include "log/read.hpp"
#include "log/rows_in_range.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

void RecordTable::add(NpyField field, std::string name, std::string meaning, std::string unit) {
    field.name = std::move(name);
    field.offset = record_size;
    record_size += field.size;
    fields.push_back(std::move(field));
    read_as.push_back(std::move(meaning));
    units.push_back(std::move(unit));
}

RecordSource::RecordSource(Name name, std::vector<std::size_t> sizes)
    : ByteSource(std::move(name)), sizes_(std::move(sizes)) {
    for (std::size_t f = 0; f < sizes_.size(); ++f) {
        kept_.push_back(f);
        record_size_ += sizes_[f];
    }
}

void RecordSource::keep(const std::vector<std::size_t>& fields) {
    std::vector<std::size_t> offsets(sizes_.size(), 0);
    std::size_t offset = 0;
    for (const std::size_t f : kept_) {
        offsets[f] = offset;
        offset += sizes_[f];
    }
    std::string made_ahead;
    for (std::size_t at = given_; at + record_size_ <= bytes_.size(); at += record_size_)
        for (const std::size_t f : fields) made_ahead.append(bytes_, at + offsets[f], sizes_[f]);
    bytes_ = std::move(made_ahead);
    given_ = 0;
    kept_ = fields;
    record_size_ = 0;
    for (const std::size_t f : kept_) record_size_ += sizes_[f];
    chosen();
}

std::size_t RecordSource::read(char* into, std::size_t size) {
    if (given_ == bytes_.size()) {
        bytes_.clear();
        given_ = 0;
        refill(bytes_);
    }
    const std::size_t taken = bytes_.copy(into, size, given_);
    given_ += taken;
    return taken;
}

std::unique_ptr<LogReader> read_records(std::unique_ptr<ByteSource> source, std::string first_bytes,
                                        const ReadOptions& options, MakeRecords make) {
    Records records = make(std::move(source), std::move(first_bytes), options);
    return rows_in_range(std::make_unique<NpyReader>(std::move(records.bytes), std::move(records.table),
                                                     options_of_whole(options)),
                         options);
}

namespace {

constexpr std::size_t clock_size = sizeof(std::int64_t), joined_buffer = std::size_t{1} << 18;
constexpr double periods_apart = 3.0, least_ns = 1e6;

enum class Join { nearest, hold, linear };

Join join_named(std::string_view word) {
    if (word == "nearest") return Join::nearest;
    if (word == "hold") return Join::hold;
    if (word == "linear") return Join::linear;
    raise<UsageError>("--join: '{}' is none of nearest, hold, linear", word);
}

std::int64_t clock_of(const char* record) {
    std::int64_t clock = 0;
    std::memcpy(&clock, record, clock_size);
    return clock;
}

// False where fewer bytes come than the record has.
bool read_record(ByteSource& source, std::string& record) {
    return read_on(source, record, 0, record.size()) == record.size();
}

/// A signal as its last message and the next.
class Side {
  public:
    Side(SideSignal signal, Join how) : signal_(std::move(signal)), how_(how) {
        signal_.type.offset = clock_size;
        record_.resize(clock_size + signal_.type.size);
        advance();
        advance();
    }
    /// At a time that is not before those asked for until now; none before the first message and behind the
    /// last.
    std::optional<double> at(std::int64_t time_ns) {
        while (after_ && after_->time_ns <= time_ns) advance();
        if (!before_ || before_->time_ns > time_ns) return std::nullopt;
        if (before_->time_ns == time_ns) return before_->value;
        if (!after_) return std::nullopt;
        const std::int64_t since = time_ns - before_->time_ns, until = after_->time_ns - time_ns;
        const std::int64_t away = how_ == Join::hold      ? since
                                  : how_ == Join::nearest ? std::min(since, until)
                                                          : std::max(since, until);
        if (away > signal_.limit_ns) {
            raise<DataError>(
                "{}: read no {} of {} within {} s of the row at {} s, expected one; leave the gap out "
                "with --from and --to, or read what has one clock",
                signal_.records->name(), signal_.noun, signal_.path,
                shortest(1e-9 * static_cast<double>(signal_.limit_ns)),
                shortest(1e-9 * static_cast<double>(time_ns)));
        }
        if (how_ == Join::hold) return before_->value;
        if (how_ == Join::nearest) return since <= until ? before_->value : after_->value;
        const double part = static_cast<double>(since) / static_cast<double>(since + until);
        return before_->value + part * (after_->value - before_->value);
    }

  private:
    struct Point {
        std::int64_t time_ns = 0;
        double value = 0.0;
    };
    void advance() {
        before_ = after_;
        after_.reset();
        if (!read_record(*signal_.records, record_)) return;
        after_ = Point{clock_of(record_.data()), load_field(record_.data(), signal_.type)};
        if (before_ && after_->time_ns < before_->time_ns)
            raise<DataError>(
                "{}: read a {} of {} that is older than the one before, expected time to run forward",
                signal_.records->name(), signal_.noun, signal_.path);
    }

    SideSignal signal_;
    Join how_;
    std::string record_;
    std::optional<Point> before_, after_;
};

class JoinedRecords final : public RecordSource {
  public:
    JoinedRecords(std::unique_ptr<RecordSource> base, std::vector<SideSignal> sides, Join how)
        : RecordSource(Name{base->name()}, with_sides(base->sizes(), sides.size())), base_(std::move(base)) {
        std::size_t base_size = 0;
        for (const std::size_t size : base_->sizes()) {
            offsets_.push_back(base_size);
            base_size += size;
        }
        record_.resize(base_size);
        for (SideSignal& side : sides) sides_.emplace_back(std::move(side), how);
    }

  private:
    static std::vector<std::size_t> with_sides(std::vector<std::size_t> sizes, std::size_t sides) {
        sizes.insert(sizes.end(), sides, sizeof(double));
        return sizes;
    }
    void refill(std::string& bytes) override {
        std::vector<double> values(sides_.size());
        while (bytes.size() < joined_buffer && read_record(*base_, record_)) {
            bool all = true;
            for (std::size_t s = 0; s < sides_.size(); ++s) {
                const auto value = sides_[s].at(clock_of(record_.data()));
                all = all && value.has_value();
                values[s] = value.value_or(0.0);
            }
            if (!all) continue;
            for (const std::size_t field : kept()) {
                if (field < offsets_.size()) {
                    bytes.append(record_, offsets_[field], sizes()[field]);
                } else {
                    std::array<char, sizeof(double)> raw{};
                    std::memcpy(raw.data(), &values[field - offsets_.size()], raw.size());
                    bytes.append(raw.data(), raw.size());
                }
            }
        }
    }

    std::unique_ptr<RecordSource> base_;
    std::vector<std::size_t> offsets_;  ///< of its fields
    std::vector<Side> sides_;
    std::string record_;
};

}  // namespace

std::int64_t join_limit_ns(double period_ns) {
    return static_cast<std::int64_t>(periods_apart * std::max(period_ns, least_ns));
}

std::unique_ptr<RecordSource> join_records(std::unique_ptr<RecordSource> base, std::vector<SideSignal> sides,
                                           std::string_view how, RecordTable& table) {
    NpyField number;
    number.big_endian = std::endian::native == std::endian::big;
    for (const SideSignal& side : sides) {
        table.add(number, side.path, side.read_as, side.unit);
        table.warnings.push_back(
            {"joined by time",
             fmt::format("{} has a clock of its own: joined to the rows by --join {}, from {}s that are up "
                         "to {} ms away; nearest, hold and linear are allowed",
                         side.path, how, side.noun, static_cast<double>(side.limit_ns) / 1e6),
             true});
    }
    table.options += fmt::format(" --join {}", how);
    return std::make_unique<JoinedRecords>(std::move(base), std::move(sides), join_named(how));
}

}  // namespace ripplenotch
