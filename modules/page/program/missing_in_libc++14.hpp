// What the sources use and the standard library of Debian's emscripten (libc++ of LLVM 14) lacks. Included before every
// source of the page's program, and by nothing else.
#pragma once

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include <strings.h>

namespace std {

#ifndef __cpp_lib_bit_cast
template <class To, class From>
[[nodiscard]] constexpr To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}
#endif

#ifndef __cpp_lib_assume_aligned
template <size_t N, class T>
[[nodiscard]] constexpr T* assume_aligned(T* pointer) {
  return static_cast<T*>(__builtin_assume_aligned(pointer, N));
}
#endif

/// Decimal notation only. The C library's strtod rounds correctly; it is shown no sign but "-", no blanks, no "0x".
inline from_chars_result from_chars(const char* first, const char* last, double& value,
                                    chars_format format = chars_format::general) {
  const auto digit = [last](const char* at) { return at != last && *at >= '0' && *at <= '9'; };
  const char* end = first + (first != last && *first == '-' ? 1 : 0);
  const char* const word = end;
  bool digits = false;
  while (digit(end)) ++end, digits = true;
  if (end != last && *end == '.') {
    const char* behind = end + 1;
    while (digit(behind)) ++behind, digits = true;
    if (digits) end = behind;
  }
  if (!digits) {
    for (const char* name : {"infinity", "inf", "nan"}) {
      const size_t length = strlen(name);
      if (static_cast<size_t>(last - word) < length || strncasecmp(word, name, length) != 0) continue;
      value = strtod(string(first, word + length).c_str(), nullptr);
      return {word + length, errc()};
    }
    return {first, errc::invalid_argument};
  }
  if (format != chars_format::fixed && end != last && (*end == 'e' || *end == 'E')) {
    const char* behind = end + 1;
    if (behind != last && (*behind == '+' || *behind == '-')) ++behind;
    if (digit(behind)) {
      while (digit(behind)) ++behind;
      end = behind;
    }
  }
  errno = 0;
  const double read = strtod(string(first, end).c_str(), nullptr);
  if (errno == ERANGE) return {end, errc::result_out_of_range};
  value = read;
  return {end, errc()};
}

/// Threads that are asked to stop. The page starts none of its own: its program runs in a worker.
class stop_token {
 public:
  stop_token() = default;
  explicit stop_token(shared_ptr<bool> asked) : asked_(std::move(asked)) {}
  [[nodiscard]] bool stop_requested() const noexcept { return asked_ && *asked_; }
  [[nodiscard]] bool stop_possible() const noexcept { return asked_ != nullptr; }

 private:
  shared_ptr<bool> asked_;
};
class stop_source {
 public:
  [[nodiscard]] stop_token get_token() const { return stop_token(asked_); }
  bool request_stop() const { return *asked_ = true; }
  [[nodiscard]] bool stop_requested() const { return *asked_; }

 private:
  shared_ptr<bool> asked_ = make_shared<bool>(false);
};
class jthread {
 public:
  jthread() = default;
  template <class Work>
  explicit jthread(Work work) {
    if constexpr (is_invocable_v<Work, stop_token>)
      thread_ = thread(std::move(work), asked_.get_token());
    else
      thread_ = thread(std::move(work));
  }
  jthread(jthread&&) = default;
  jthread& operator=(jthread&&) = default;
  ~jthread() {
    if (joinable()) request_stop(), join();
  }
  [[nodiscard]] bool joinable() const { return thread_.joinable(); }
  bool request_stop() { return asked_.request_stop(); }
  [[nodiscard]] stop_token get_stop_token() const { return asked_.get_token(); }
  void join() { thread_.join(); }

 private:
  stop_source asked_;
  thread thread_;
};

/// The algorithms over whole ranges that the sources use.
namespace ranges {

template <class Compare, class Projection>
[[nodiscard]] auto projected_by(Compare& compare, Projection& projection) {
  return [&](auto&& a, auto&& b) -> bool {
    return std::invoke(compare, std::invoke(projection, a), std::invoke(projection, b));
  };
}

template <class Range, class Test, class Projection = std::identity>
[[nodiscard]] auto find_if(Range&& range, Test test, Projection of = {}) {
  return std::find_if(std::begin(range), std::end(range),
                      [&](auto&& one) -> bool { return std::invoke(test, std::invoke(of, one)); });
}
template <class Range, class Value, class Projection = std::identity>
[[nodiscard]] auto find(Range&& range, const Value& value, Projection of = {}) {
  return std::find_if(std::begin(range), std::end(range),
                      [&](auto&& one) -> bool { return std::invoke(of, one) == value; });
}
template <class Range, class Test, class Projection = std::identity>
[[nodiscard]] bool any_of(Range&& range, Test test, Projection of = {}) {
  return std::any_of(std::begin(range), std::end(range),
                     [&](auto&& one) -> bool { return std::invoke(test, std::invoke(of, one)); });
}
template <class Range, class Test, class Projection = std::identity>
[[nodiscard]] bool all_of(Range&& range, Test test, Projection of = {}) {
  return std::all_of(std::begin(range), std::end(range),
                     [&](auto&& one) -> bool { return std::invoke(test, std::invoke(of, one)); });
}
template <class Range, class Test, class Projection = std::identity>
[[nodiscard]] bool none_of(Range&& range, Test test, Projection of = {}) {
  return !ranges::any_of(range, std::move(test), std::move(of));
}
template <class Range, class Test, class Projection = std::identity>
[[nodiscard]] auto count_if(Range&& range, Test test, Projection of = {}) {
  return std::count_if(std::begin(range), std::end(range),
                       [&](auto&& one) -> bool { return std::invoke(test, std::invoke(of, one)); });
}
template <class Range, class Value, class Projection = std::identity>
[[nodiscard]] auto count(Range&& range, const Value& value, Projection of = {}) {
  return std::count_if(std::begin(range), std::end(range),
                       [&](auto&& one) -> bool { return std::invoke(of, one) == value; });
}
template <class Range, class Compare = std::less<>, class Projection = std::identity>
[[nodiscard]] auto max_element(Range&& range, Compare compare = {}, Projection of = {}) {
  return std::max_element(std::begin(range), std::end(range), projected_by(compare, of));
}
template <class Range, class Compare = std::less<>, class Projection = std::identity>
[[nodiscard]] auto min_element(Range&& range, Compare compare = {}, Projection of = {}) {
  return std::min_element(std::begin(range), std::end(range), projected_by(compare, of));
}
template <class Iterator>
struct LeastAndGreatest {
  Iterator min, max;
};
template <class Range, class Compare = std::less<>, class Projection = std::identity>
[[nodiscard]] auto minmax_element(Range&& range, Compare compare = {}, Projection of = {}) {
  const auto found = std::minmax_element(std::begin(range), std::end(range), projected_by(compare, of));
  return LeastAndGreatest<decltype(std::begin(range))>{found.first, found.second};
}
template <class Range, class Compare = std::less<>, class Projection = std::identity>
[[nodiscard]] auto max(Range&& range, Compare compare = {}, Projection of = {}) {
  return *ranges::max_element(range, std::move(compare), std::move(of));
}
template <class Range, class Compare = std::less<>, class Projection = std::identity>
[[nodiscard]] auto min(Range&& range, Compare compare = {}, Projection of = {}) {
  return *ranges::min_element(range, std::move(compare), std::move(of));
}
template <class Range, class Compare = std::equal_to<>, class Projection = std::identity>
[[nodiscard]] auto adjacent_find(Range&& range, Compare compare = {}, Projection of = {}) {
  return std::adjacent_find(std::begin(range), std::end(range), projected_by(compare, of));
}
template <class Range, class Compare = std::less<>, class Projection = std::identity>
[[nodiscard]] bool is_sorted(Range&& range, Compare compare = {}, Projection of = {}) {
  return std::is_sorted(std::begin(range), std::end(range), projected_by(compare, of));
}
template <class Range, class Compare = std::less<>, class Projection = std::identity>
void sort(Range&& range, Compare compare = {}, Projection of = {}) {
  std::sort(std::begin(range), std::end(range), projected_by(compare, of));
}
template <class Range, class Compare = std::less<>, class Projection = std::identity>
void stable_sort(Range&& range, Compare compare = {}, Projection of = {}) {
  std::stable_sort(std::begin(range), std::end(range), projected_by(compare, of));
}
template <class Range, class Value, class Compare = std::less<>, class Projection = std::identity>
[[nodiscard]] auto lower_bound(Range&& range, const Value& value, Compare compare = {}, Projection of = {}) {
  return std::lower_bound(std::begin(range), std::end(range), value, [&](auto&& one, auto&& wanted) -> bool {
    return std::invoke(compare, std::invoke(of, one), wanted);
  });
}
template <class Range, class Value, class Compare = std::less<>, class Projection = std::identity>
[[nodiscard]] auto upper_bound(Range&& range, const Value& value, Compare compare = {}, Projection of = {}) {
  return std::upper_bound(std::begin(range), std::end(range), value, [&](auto&& wanted, auto&& one) -> bool {
    return std::invoke(compare, wanted, std::invoke(of, one));
  });
}
template <class Range, class Value>
[[nodiscard]] bool binary_search(Range&& range, const Value& value) {
  return std::binary_search(std::begin(range), std::end(range), value);
}
template <class Range, class Other, class Compare = std::equal_to<>, class First = std::identity,
          class Second = std::identity>
[[nodiscard]] bool equal(Range&& range, Other&& other, Compare compare = {}, First first = {}, Second second = {}) {
  return std::equal(
      std::begin(range), std::end(range), std::begin(other), std::end(other),
      [&](auto&& a, auto&& b) -> bool { return std::invoke(compare, std::invoke(first, a), std::invoke(second, b)); });
}
template <class Iterator>
struct Rest {
  Iterator first, last;
  [[nodiscard]] Iterator begin() const { return first; }
  [[nodiscard]] Iterator end() const { return last; }
};
template <class Range, class Test, class Projection = std::identity>
auto stable_partition(Range&& range, Test test, Projection of = {}) {
  const auto second = std::stable_partition(
      std::begin(range), std::end(range), [&](auto&& one) -> bool { return std::invoke(test, std::invoke(of, one)); });
  return Rest<decltype(std::begin(range))>{second, std::end(range)};
}
template <class Range, class Into>
void copy(Range&& range, Into into) {
  std::copy(std::begin(range), std::end(range), into);
}
template <class Range, class Value>
void fill(Range&& range, const Value& value) {
  std::fill(std::begin(range), std::end(range), value);
}
template <class Range>
void reverse(Range&& range) {
  std::reverse(std::begin(range), std::end(range));
}

}  // namespace ranges
}  // namespace std
