// SPDX-License-Identifier: MIT
// The way through the messages of a topic, written down while the first is gone through.

#include <fmt/format.h>

#include "log/messages/cdr_cursor.hpp"
#include "log/messages/cdr_program.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

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
        steps.push_back({CdrStep::Kind::length_is, 0, count, 0, path, {}, {}});
        for (std::uint32_t i = 0; i < count; ++i) {
            names.emplace_back(cursor_.text());
            steps.push_back(
                {CdrStep::Kind::text_is, 0, 1, 0, fmt::format("{}[{}]", path, i), names.back(), {}});
        }
    }
    void add_field(const RosField& field, const std::string& path, std::vector<CdrStep>& steps) {
        if (field.count == RosField::Count::one) return add_one(field.type, path, path, steps);
        const bool any = field.count == RosField::Count::any;
        CdrCursor ahead = cursor_;
        const std::size_t count = any ? ahead.length() : field.fixed;
        const bool listed =
            count > 0 && count <= most_listed_elements && field.type.kind != RosType::Kind::text;
        if (!listed) return pass_over(field, count, steps);
        if (any) {
            cursor_.length();
            steps.push_back({CdrStep::Kind::length_is, 0, count, 0, path, {}, {}});
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
                leaves.push_back(leaf);
                break;
            }
        }
        pass_cdr(cursor_, step);
        steps.push_back(std::move(step));
    }
    // Without leaves, whatever its length in the next message.
    void pass_over(const RosField& field, std::size_t count, std::vector<CdrStep>& steps) {
        const bool any = field.count == RosField::Count::any;
        CdrStep step;
        if (field.type.kind == RosType::Kind::number) {
            step = {any ? CdrStep::Kind::skip_any : CdrStep::Kind::skip,
                    field.type.size,
                    count,
                    0,
                    field.name,
                    {},
                    {}};
        } else if (field.type.kind == RosType::Kind::text && any) {
            step.kind = CdrStep::Kind::texts;
        } else {
            RosField one = field;
            one.count = RosField::Count::one;
            std::vector<CdrStep> inner = steps_without_leaves(one);
            if (!any) {
                for (std::size_t i = 0; i < count; ++i) {
                    pass_cdr(cursor_, inner);
                    if (steps.size() > most_steps)
                        raise<DataError>("messages of more than {} fields", most_steps);
                    steps.insert(steps.end(), inner.begin(), inner.end());
                }
                return;
            }
            step.kind = CdrStep::Kind::repeat_any;
            step.inner = std::move(inner);
        }
        pass_cdr(cursor_, step);
        steps.push_back(std::move(step));
    }
    static std::vector<CdrStep> steps_without_leaves(const RosField& field) {
        std::vector<CdrStep> steps;
        const bool any = field.count == RosField::Count::any;
        for (std::size_t i = 0; i < (any ? 1 : field.fixed); ++i) {
            CdrStep step;
            if (field.type.kind == RosType::Kind::number) {
                step = {CdrStep::Kind::skip, field.type.size, 1, 0, field.name, {}, {}};
            } else if (field.type.kind == RosType::Kind::stamp) {
                step = {CdrStep::Kind::skip, 4, 2, 0, field.name, {}, {}};
            } else if (field.type.kind == RosType::Kind::text) {
                step.kind = CdrStep::Kind::text;
            } else if (field.type.kind == RosType::Kind::wide_text) {
                raise<DataError>("the field {} of wide text, which is not read", field.name);
            } else {
                for (const RosField& inner : field.type.fields) {
                    const auto more = steps_without_leaves(inner);
                    steps.insert(steps.end(), more.begin(), more.end());
                    if (steps.size() > most_steps)
                        raise<DataError>("messages of more than {} fields", most_steps);
                }
                continue;
            }
            steps.push_back(step);
            if (steps.size() > most_steps) raise<DataError>("messages of more than {} fields", most_steps);
        }
        if (!any) return steps;
        CdrStep loop;
        loop.kind = CdrStep::Kind::repeat_any;
        loop.inner = std::move(steps);
        return {loop};
    }

    CdrCursor cursor_;
    const std::vector<std::string>* names_ = nullptr;  ///< of joints, in the record that is laid out
};

}  // namespace

MessageLayout lay_out_cdr(const RosType& type, std::string_view message) {
    std::vector<CdrStep> steps;
    LayOut work(message);
    work.record(type, "", steps);
    return {std::move(work.leaves), cdr_program(std::move(steps))};
}

}  // namespace ripplenotch
