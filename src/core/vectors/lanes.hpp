// SPDX-License-Identifier: MIT
#pragma once
// Four doubles side by side, for loops that are worth it. Each lane is an ordinary double with ordinary
// rounding, so the bits do not depend on how lanes are held: in one register of AVX2 (Four), or in two of
// what every x86-64 and arm64 has (TwoAndTwo).
//
// A kernel is written once over the type:
//
//     struct SumUp {
//         template <class Lanes>
//         RIPPLENOTCH_INLINED static double run(std::span<const double> values) { ... }
//     };
//     double sum_up(std::span<const double> values) { return in_lanes<SumUp>(values); }
//
// Everything is inlined, and lanes go by reference: a value may not be handed to a function that has no
// register for it.

#include <cstddef>
#include <type_traits>

#define RIPPLENOTCH_INLINED inline __attribute__((always_inline))
#if defined(__x86_64__) && defined(__GNUC__)
#define RIPPLENOTCH_WIDE __attribute__((target("avx2")))
#else
#define RIPPLENOTCH_WIDE
#endif

namespace ripplenotch {

// Which vectors may be used here, the one question, and what functions need that are built for them.
//
// Wide vectors are AVX2 on x86-64 and NEON on arm64, where every processor has it. Without them numbers go
// two by two and characters one by one. Contraction is off for the whole build and no fused
// operation is used, so the bytes of a result do not depend on the answer.

/// True on processors with wide vectors, unless somebody holds NarrowVectors, or RIPPLENOTCH_VECTORS=none is
/// in the environment.
[[nodiscard]] bool wide_vectors() noexcept;

/// While it lives, all is done as on a processor without wide vectors: tests hold every kernel to its plain
/// form that way. What asks once, when it is made, goes on with the answer.
class NarrowVectors {
  public:
    NarrowVectors() noexcept;
    ~NarrowVectors();
    NarrowVectors(const NarrowVectors&) = delete;
    NarrowVectors& operator=(const NarrowVectors&) = delete;

  private:
    bool before_;
};

inline constexpr std::size_t lane_count = 4;

/// Vectors of 32 and of 16 bytes.
template <class Number>
using OneRegister __attribute__((vector_size(32))) = Number;
template <class Number>
using HalfRegister __attribute__((vector_size(16))) = Number;
template <class Number>
struct TwoRegisters {
    HalfRegister<Number> low, high;
};

using Four = OneRegister<double>;
using Two = HalfRegister<double>;
using TwoAndTwo = TwoRegisters<double>;

/// The bits of lanes; of a comparison: all of a lane, or none.
template <class Lanes>
using BitsOf =
    std::conditional_t<std::is_same_v<Lanes, Four>, OneRegister<long long>, TwoRegisters<long long>>;

// What one register does by itself, for two.
#define RIPPLENOTCH_LANEWISE(op)                                                                           \
    template <class N>                                                                                     \
    RIPPLENOTCH_INLINED TwoRegisters<N> operator op(const TwoRegisters<N>& a, const TwoRegisters<N>& b) {  \
        return {a.low op b.low, a.high op b.high};                                                         \
    }                                                                                                      \
    template <class N>                                                                                     \
    RIPPLENOTCH_INLINED TwoRegisters<N> operator op(const TwoRegisters<N>& a, std::type_identity_t<N> b) { \
        return {a.low op b, a.high op b};                                                                  \
    }                                                                                                      \
    template <class N, class B>                                                                            \
    RIPPLENOTCH_INLINED TwoRegisters<N>& operator op##=(TwoRegisters<N>& a, const B& b) {                  \
        return a = a op b;                                                                                 \
    }
RIPPLENOTCH_LANEWISE(+)
RIPPLENOTCH_LANEWISE(-)
RIPPLENOTCH_LANEWISE(*)
RIPPLENOTCH_LANEWISE(/)
RIPPLENOTCH_LANEWISE(&)
RIPPLENOTCH_LANEWISE(|)
RIPPLENOTCH_LANEWISE(^)
#undef RIPPLENOTCH_LANEWISE

template <class N>
RIPPLENOTCH_INLINED TwoRegisters<N> operator-(const TwoRegisters<N>& a) {
    return {-a.low, -a.high};
}
template <class N>
RIPPLENOTCH_INLINED TwoRegisters<N> operator~(const TwoRegisters<N>& a) {
    return {~a.low, ~a.high};
}
template <class N>
RIPPLENOTCH_INLINED TwoRegisters<N> operator<<(const TwoRegisters<N>& a, int bits) {
    return {a.low << bits, a.high << bits};
}
template <class N>
RIPPLENOTCH_INLINED TwoRegisters<N> operator>>(const TwoRegisters<N>& a, int bits) {
    return {a.low >> bits, a.high >> bits};
}

#define RIPPLENOTCH_COMPARISON(op)                                                             \
    template <class N>                                                                         \
    RIPPLENOTCH_INLINED auto operator op(const TwoRegisters<N>& a, const TwoRegisters<N>& b) { \
        using Bits = std::conditional_t<sizeof(N) == 1, signed char, long long>;               \
        return TwoRegisters<Bits>{reinterpret_cast<HalfRegister<Bits>>(a.low op b.low),        \
                                  reinterpret_cast<HalfRegister<Bits>>(a.high op b.high)};     \
    }
RIPPLENOTCH_COMPARISON(==)
RIPPLENOTCH_COMPARISON(<)
RIPPLENOTCH_COMPARISON(<=)
RIPPLENOTCH_COMPARISON(>)
#undef RIPPLENOTCH_COMPARISON

// Copied as bytes, which is one instruction for any address of a double: clang aligns a vector type whatever
// is said.
RIPPLENOTCH_INLINED void load(Four& lanes, const double* from) {
    __builtin_memcpy(&lanes, from, sizeof lanes);
}
RIPPLENOTCH_INLINED void load(TwoAndTwo& lanes, const double* from) {
    __builtin_memcpy(&lanes.low, from, sizeof lanes.low);
    __builtin_memcpy(&lanes.high, from + 2, sizeof lanes.high);
}

RIPPLENOTCH_INLINED void store(double* to, const Four& lanes) { __builtin_memcpy(to, &lanes, sizeof lanes); }
RIPPLENOTCH_INLINED void store(double* to, const TwoAndTwo& lanes) {
    __builtin_memcpy(to, &lanes.low, sizeof lanes.low);
    __builtin_memcpy(to + 2, &lanes.high, sizeof lanes.high);
}

RIPPLENOTCH_INLINED void fill(Four& lanes, double value) { lanes = Four{value, value, value, value}; }
RIPPLENOTCH_INLINED void fill(TwoAndTwo& lanes, double value) {
    lanes = {Two{value, value}, Two{value, value}};
}

RIPPLENOTCH_INLINED double sum(const Four& lanes) { return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]); }
RIPPLENOTCH_INLINED double sum(const TwoAndTwo& lanes) {
    return (lanes.low[0] + lanes.low[1]) + (lanes.high[0] + lanes.high[1]);
}
RIPPLENOTCH_INLINED long long sum(const BitsOf<Four>& bits) { return bits[0] + bits[1] + bits[2] + bits[3]; }
RIPPLENOTCH_INLINED long long sum(const BitsOf<TwoAndTwo>& bits) {
    const HalfRegister<long long> both = bits.low + bits.high;
    return both[0] + both[1];
}

RIPPLENOTCH_INLINED void to_bits(BitsOf<Four>& bits, const Four& lanes) {
    bits = reinterpret_cast<BitsOf<Four>>(lanes);
}
RIPPLENOTCH_INLINED void to_bits(BitsOf<TwoAndTwo>& bits, const TwoAndTwo& lanes) {
    bits.low = reinterpret_cast<HalfRegister<long long>>(lanes.low);
    bits.high = reinterpret_cast<HalfRegister<long long>>(lanes.high);
}
RIPPLENOTCH_INLINED void from_bits(Four& lanes, const BitsOf<Four>& bits) {
    lanes = reinterpret_cast<Four>(bits);
}
RIPPLENOTCH_INLINED void from_bits(TwoAndTwo& lanes, const BitsOf<TwoAndTwo>& bits) {
    lanes = {reinterpret_cast<Two>(bits.low), reinterpret_cast<Two>(bits.high)};
}

template <class Lanes>
RIPPLENOTCH_INLINED void drop_signs(Lanes& lanes) {
    BitsOf<Lanes> bits;
    to_bits(bits, lanes);
    bits &= 0x7FFF'FFFF'FFFF'FFFF;
    from_bits(lanes, bits);
}

/// Of each lane the bits where `mask` has them set, from `other` elsewhere.
template <class Lanes>
RIPPLENOTCH_INLINED void choose(Lanes& lanes, const BitsOf<Lanes>& mask, const Lanes& other) {
    BitsOf<Lanes> bits, other_bits;
    to_bits(bits, lanes);
    to_bits(other_bits, other);
    bits = other_bits ^ ((bits ^ other_bits) & mask);
    from_bits(lanes, bits);
}

template <class Lanes>
RIPPLENOTCH_INLINED void flip_signs(Lanes& lanes, const BitsOf<Lanes>& sign_bits) {
    BitsOf<Lanes> bits;
    to_bits(bits, lanes);
    bits ^= sign_bits;
    from_bits(lanes, bits);
}

/// Each lane becomes `by` where that is smaller; so one that is not a number changes nothing.
RIPPLENOTCH_INLINED void lower(Four& lanes, const Four& by) { lanes = by < lanes ? by : lanes; }
RIPPLENOTCH_INLINED void lower(TwoAndTwo& lanes, const TwoAndTwo& by) {
    lanes.low = by.low < lanes.low ? by.low : lanes.low;
    lanes.high = by.high < lanes.high ? by.high : lanes.high;
}
/// The same where it is larger.
RIPPLENOTCH_INLINED void raise(Four& lanes, const Four& by) { lanes = lanes < by ? by : lanes; }
RIPPLENOTCH_INLINED void raise(TwoAndTwo& lanes, const TwoAndTwo& by) {
    lanes.low = lanes.low < by.low ? by.low : lanes.low;
    lanes.high = lanes.high < by.high ? by.high : lanes.high;
}

RIPPLENOTCH_INLINED bool all_set(const BitsOf<Four>& bits) {
    return (bits[0] & bits[1] & bits[2] & bits[3]) == -1;
}
RIPPLENOTCH_INLINED bool all_set(const BitsOf<TwoAndTwo>& bits) {
    const HalfRegister<long long> both = bits.low & bits.high;
    return (both[0] & both[1]) == -1;
}

template <class Kernel, class... Arguments>
RIPPLENOTCH_WIDE auto in_four_lanes(Arguments... arguments) {
    return Kernel::template run<Four>(arguments...);
}

/// Kernel::run<Lanes>(arguments...), with the lanes of this processor. Arguments are copied: what the kernel
/// writes to goes by span or pointer.
template <class Kernel, class... Arguments>
auto in_lanes(const Arguments&... arguments) {
#if defined(__x86_64__)
    if (wide_vectors()) return in_four_lanes<Kernel, Arguments...>(arguments...);
#endif
    return Kernel::template run<TwoAndTwo>(arguments...);
}

}  // namespace ripplenotch
