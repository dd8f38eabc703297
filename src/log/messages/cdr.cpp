// SPDX-License-Identifier: MIT
// Messages in CDR (OMG's Common Data Representation, version 1, as ROS 2 writes it): which numbers are in the
// first of a topic, and a short program that takes them out of the next million.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "log/messages/message_columns.hpp"
#include "log/messages/ros_schema.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

namespace {

// Where a message in CDR is read: numbers at multiples of their size, texts and lists behind their lengths.

/// One step through a message.
struct CdrStep {
    enum class Kind {
        number,    ///< of `size` bytes, kept
        stamp,     ///< of eight bytes, kept
        skip,      ///< `count` numbers of `size` bytes
        skip_any,  ///< as many as stand in front
        text,
        text_is,     ///< `expected`
        length_is,   ///< `count` in front of a sequence
        repeat_any,  ///< `inner`, as many times as stand in front
    };
    Kind kind = Kind::skip;
    std::size_t size = 0, count = 1, leaf = 0;
    NpyField type = {};  ///< of a number that is kept
    std::string path, expected;
    std::vector<CdrStep> inner;
};

constexpr std::size_t cdr_head = 4;  // says the byte order

/// Throws DataError, without a source's name, where the message ends.
class CdrCursor {
  public:
    explicit CdrCursor(std::string_view message) : bytes_(message) {
        if (message.size() < cdr_head)
            raise<DataError>("a message of {} bytes, expected 4 or more", message.size());
        if (message[0] != '\0' || (message[1] != '\0' && message[1] != '\1'))
            raise<DataError>("a message in another encoding of CDR ({:#04x} {:#04x}), expected version 1",
                             static_cast<unsigned char>(message[0]), static_cast<unsigned char>(message[1]));
        swaps_ = (message[1] == '\0') != (std::endian::native == std::endian::big);
        bytes_.remove_prefix(cdr_head);
    }
    // Numbers stand at multiples of their size.
    const char* take(std::size_t size, std::size_t count = 1) {
        const std::size_t at = (at_ + size - 1) & ~(size - 1);
        if (at > bytes_.size() || count > (bytes_.size() - at) / size)
            raise<DataError>("a message that ends after {} bytes, expected {} numbers of {} bytes more",
                             bytes_.size() + cdr_head, count, size);
        at_ = at + count * size;
        return bytes_.data() + at;
    }
    void number(std::size_t size, char* into) {
        const char* const from = take(size);
        if (swaps_)
            std::reverse_copy(from, from + size, into);
        else
            std::memcpy(into, from, size);
    }
    std::uint32_t length() {
        std::uint32_t value = 0;
        number(4, reinterpret_cast<char*>(&value));
        return value;
    }
    // The length of a list whose elements take a byte or more each.
    std::uint32_t list_length() {
        const std::uint32_t count = length();
        if (count > bytes_.size() - at_)
            raise<DataError>("a list of {} things in the {} bytes that are left of a message, expected fewer",
                             count, bytes_.size() - at_);
        return count;
    }
    std::string_view text() {
        const std::uint32_t size = length();
        std::string_view text(take(1, size), size);
        if (text.ends_with('\0')) text.remove_suffix(1);
        return text;
    }
    std::int64_t stamp() {
        std::int32_t seconds = 0;
        std::uint32_t nanoseconds = 0;
        number(4, reinterpret_cast<char*>(&seconds));
        number(4, reinterpret_cast<char*>(&nanoseconds));
        return std::int64_t{seconds} * 1'000'000'000 + nanoseconds;
    }

  private:
    std::string_view bytes_;
    std::size_t at_ = 0;
    bool swaps_ = false;
};

// Reads on over what a step says, and checks what it demands.
void pass_cdr(CdrCursor& cursor, const CdrStep& step);

void pass_cdr(CdrCursor& cursor, const std::vector<CdrStep>& steps) {
    for (const CdrStep& step : steps) pass_cdr(cursor, step);
}

void pass_cdr(CdrCursor& cursor, const CdrStep& step) {
    switch (step.kind) {
        case CdrStep::Kind::number:
            cursor.take(step.size);
            break;
        case CdrStep::Kind::stamp:
            cursor.take(4, 2);
            break;
        case CdrStep::Kind::skip:
            if (step.count > 0) cursor.take(step.size, step.count);
            break;
        case CdrStep::Kind::skip_any:
            if (const std::uint32_t count = cursor.length(); count > 0) cursor.take(step.size, count);
            break;
        case CdrStep::Kind::text:
            cursor.text();
            break;
        case CdrStep::Kind::text_is:
            if (const std::string_view text = cursor.text(); text != step.expected)
                raise<DataError>(
                    "'{}' as {}, expected '{}' as in the first message; record the joints on topics of their "
                    "own",
                    text.substr(0, 60), step.path, step.expected);
            break;
        case CdrStep::Kind::length_is:
            if (const std::uint32_t count = cursor.length(); count != step.count)
                raise<DataError>(
                    "{} elements of {}, expected {} as in the first message; record messages of one shape on "
                    "a topic",
                    count, step.path, step.count);
            break;
        case CdrStep::Kind::repeat_any:
            for (std::uint32_t left = cursor.list_length(); left > 0; --left) pass_cdr(cursor, step.inner);
            break;
    }
}

bool keeps(const CdrStep& step) {
    return step.kind == CdrStep::Kind::number || step.kind == CdrStep::Kind::stamp;
}

class CdrReader final : public MessageReader {
  public:
    CdrReader(std::shared_ptr<const std::vector<CdrStep>> steps, const std::vector<bool>& wanted)
        : steps_(std::move(steps)), count_(steps_->size()), wanted_(wanted) {
        // Behind the last useful step there is nothing to go on for.
        const auto useful = [&](const CdrStep& step) {
            return keeps(step) ? wanted_[step.leaf] : step.kind == CdrStep::Kind::length_is;
        };
        while (count_ > 0 && !useful((*steps_)[count_ - 1])) --count_;
    }
    void read(std::string_view message, std::vector<LeafNumber>& into) override {
        CdrCursor cursor(message);
        for (std::size_t s = 0; s < count_; ++s) {
            const CdrStep& step = (*steps_)[s];
            if (!keeps(step) || !wanted_[step.leaf]) {
                pass_cdr(cursor, step);
                continue;
            }
            std::array<char, 8> raw{};
            if (step.kind == CdrStep::Kind::number)
                cursor.number(step.size, raw.data());
            else
                raw = std::bit_cast<std::array<char, 8>>(cursor.stamp());
            into[step.leaf].value = load_field(raw.data(), step.type);
            if (step.type.whole()) into[step.leaf].count = load_count(raw.data(), step.type);
        }
    }

  private:
    std::shared_ptr<const std::vector<CdrStep>> steps_;
    std::size_t count_;
    std::vector<bool> wanted_;  ///< by leaf
};

constexpr std::size_t most_leaves = 4096, most_steps = 100000;

/// Goes through the first message and writes down the way.
class LayOut {
  public:
    explicit LayOut(std::string_view message) : cursor_(message) {}
    void record(const RosType& type, const std::string& prefix, std::vector<CdrStep>& steps) {
        const std::vector<std::string>* const outer = names_;
        std::vector<std::string> names;
        names_ = nullptr;
        for (const RosField& field : type.fields) {
            const bool joint_names =
                field.name == "name" || field.name == "joint_names" || field.name == "names";
            const bool texts = field.type.kind == RosType::Kind::text && field.count == RosField::Count::any;
            if (joint_names && texts) {
                take_names(prefix + field.name, names, steps);
                names_ = &names;
            } else {
                add_field(field, prefix + field.name, steps);
            }
        }
        names_ = outer;
    }
    std::vector<MessageLeaf> leaves;

  private:
    void take_names(const std::string& path, std::vector<std::string>& names, std::vector<CdrStep>& steps) {
        const std::uint32_t count = cursor_.length();
        if (count > 10000) raise<DataError>("{} names of joints", count);
        steps.push_back({CdrStep::Kind::length_is, 0, count, 0, {}, path, {}, {}});
        for (std::uint32_t i = 0; i < count; ++i) {
            names.emplace_back(cursor_.text());
            steps.push_back(
                {CdrStep::Kind::text_is, 0, 1, 0, {}, fmt::format("{}[{}]", path, i), names.back(), {}});
        }
    }
    void add_field(const RosField& field, const std::string& path, std::vector<CdrStep>& steps) {
        if (field.count == RosField::Count::one) return add_one(field.type, path, path, steps);
        const bool any = field.count == RosField::Count::any;
        CdrCursor ahead = cursor_;
        const std::size_t count = any ? ahead.length() : field.fixed;
        const bool listed =
            count > 0 && count <= most_listed_elements && field.type.kind != RosType::Kind::text;
        if (!listed) return pass_over(field, steps);
        if (any) {
            cursor_.length();
            steps.push_back({CdrStep::Kind::length_is, 0, count, 0, {}, path, {}, {}});
        }
        for (std::size_t i = 0; i < count; ++i) {
            const bool named = names_ != nullptr && names_->size() == count;
            add_one(field.type, fmt::format("{}[{}]", path, i),
                    named ? fmt::format("{} {}", (*names_)[i], field.name) : fmt::format("{}[{}]", path, i),
                    steps);
        }
    }
    void add_one(const RosType& type, const std::string& path, const std::string& read_as,
                 std::vector<CdrStep>& steps) {
        CdrStep step;
        step.path = path;
        switch (type.kind) {
            case RosType::Kind::record:
                return record(type, path + ".", steps);
            case RosType::Kind::wide_text:
                raise<DataError>("the field {} of wide text, which is not read", path);
            case RosType::Kind::text:
                step.kind = CdrStep::Kind::text;
                break;
            case RosType::Kind::number:
            case RosType::Kind::stamp: {
                const bool stamp = type.kind == RosType::Kind::stamp;
                step.kind = stamp ? CdrStep::Kind::stamp : CdrStep::Kind::number;
                step.size = type.size;
                step.leaf = leaves.size();
                MessageLeaf leaf{path, read_as, {}, stamp, path == "header.stamp"};
                leaf.type.kind = stamp ? 'i' : type.number;
                leaf.type.size = stamp ? 8 : type.size;
                leaf.type.big_endian = std::endian::native == std::endian::big;
                if (leaves.size() == most_leaves)
                    raise<DataError>("messages of more than {} numbers", most_leaves);
                step.type = leaf.type;
                leaves.push_back(leaf);
                break;
            }
        }
        pass_cdr(cursor_, step);
        steps.push_back(std::move(step));
    }
    // Without leaves, whatever its length in the next message.
    void pass_over(const RosField& field, std::vector<CdrStep>& steps) {
        const std::vector<CdrStep> passing = steps_without_leaves(field);
        pass_cdr(cursor_, passing);
        append(passing, steps);
    }
    static void append(const std::vector<CdrStep>& more, std::vector<CdrStep>& steps) {
        steps.insert(steps.end(), more.begin(), more.end());
        if (steps.size() > most_steps) raise<DataError>("messages of more than {} fields", most_steps);
    }
    static std::vector<CdrStep> steps_without_leaves(const RosField& field) {
        const bool any = field.count == RosField::Count::any;
        const std::size_t count = field.count == RosField::Count::fixed ? field.fixed : 1;
        CdrStep step;
        std::vector<CdrStep> one;
        switch (field.type.kind) {
            case RosType::Kind::number:
                step.kind = any ? CdrStep::Kind::skip_any : CdrStep::Kind::skip;
                step.size = field.type.size;
                step.count = count;
                return {step};
            case RosType::Kind::wide_text:
                raise<DataError>("the field {} of wide text, which is not read", field.name);
            case RosType::Kind::text:
                step.kind = CdrStep::Kind::text;
                one = {step};
                break;
            case RosType::Kind::stamp:
                step.size = 4;
                step.count = 2;
                one = {step};
                break;
            case RosType::Kind::record:
                for (const RosField& inner : field.type.fields) append(steps_without_leaves(inner), one);
                break;
        }
        if (any) {
            step.kind = CdrStep::Kind::repeat_any;
            step.inner = std::move(one);
            return {step};
        }
        std::vector<CdrStep> steps;
        for (std::size_t i = 0; i < count; ++i) append(one, steps);
        return steps;
    }

    CdrCursor cursor_;
    const std::vector<std::string>* names_ = nullptr;  ///< of joints, in the record that is laid out
};

}  // namespace

MessageLayout lay_out_cdr(const RosType& type, std::string_view message) {
    std::vector<CdrStep> steps;
    LayOut work(message);
    work.record(type, "", steps);
    const auto shared = std::make_shared<const std::vector<CdrStep>>(std::move(steps));
    return {std::move(work.leaves),
            [shared](const std::vector<bool>& wanted) -> std::unique_ptr<MessageReader> {
                return std::make_unique<CdrReader>(shared, wanted);
            }};
}

}  // namespace ripplenotch
