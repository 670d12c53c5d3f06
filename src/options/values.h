// Kinds of options' values, for the rows of a table.
//
// A value names its struct by a function and its field by a pointer to the member:
//
//     const auto erode = [](auto& o) -> auto& { return o.fracture.erode; };
//     number(erode, &ErodeOptions::threshold, between(1e-6, 1.0))
#pragma once

#include <sherd/options.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/text/number_text.h"
#include "base/text/option_text.h"

namespace sherd {

/// Numbers from `low` to `high`, or above `low`.
struct NumberRange {
  double low = 0.0, high = std::numeric_limits<double>::max();
  bool isAbove = false;  ///< `low` itself is not in the range
  std::string text;
};

[[nodiscard]] inline NumberRange between(double low, double high, std::string text) {
  return {low, high, false, std::move(text)};
}
[[nodiscard]] inline NumberRange aboveZero() { return {.isAbove = true, .text = "> 0"}; }

template <class Number>
[[nodiscard]] std::string shortestText(Number value) {
  std::string text;
  appendShortest(text, value);
  return text;
}

/// Returns the whole decimal number in low..high that the text is.
///   throws  Error(usage)
template <class Whole>
[[nodiscard]] Whole wholeFrom(const std::string& text, Whole low, Whole high) {
  Whole value{};
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end || value < low || value > high) {
    refuseValue(text, "a whole number in " + std::to_string(low) + ".." + std::to_string(high));
  }
  return value;
}

/// Returns the index of a text among names.
///   throws  Error(usage)
[[nodiscard]] inline std::size_t indexOf(const std::string& text,
                                         const std::vector<std::string>& names) {
  const auto found = std::find(names.begin(), names.end(), text);
  if (found == names.end()) refuseValue(text, "one of " + joinedText(names, ", "));
  return static_cast<std::size_t>(found - names.begin());
}

[[nodiscard]] inline std::vector<std::string> textsOf(const std::vector<int>& numbers) {
  std::vector<std::string> texts;
  for (const int number : numbers) texts.push_back(std::to_string(number));
  return texts;
}

/// Returns the length that the text is, not negative, or nullopt.
[[nodiscard]] inline std::optional<Length> lengthIn(const std::string& text) {
  const bool isRelative = text.ends_with('%');
  const std::optional<double> value = numberIn(text.substr(0, text.size() - (isRelative ? 1 : 0)));
  if (!value || *value < 0.0 || (isRelative && *value > 100.0)) return {};
  return isRelative ? Length::ofSide(*value) : Length(*value);
}

[[nodiscard]] inline std::string lengthText(const Length& length) {
  return length.percent > 0.0 ? shortestText(length.percent) + "%" : shortestText(length.voxels);
}

/// Returns the percentage that the text is.
///   throws  Error(usage)
[[nodiscard]] inline Length percentageFrom(const std::string& text) {
  const std::optional<Length> value = lengthIn(text);
  if (!value) refuseValue(text, "a percentage in 0..100%");
  return *value;
}

/// The kinds of values of options in a `Target`.
template <class Target>
struct ValuesOf {
  using Value = OptionValue<Target>;

  /// A value with functions of its own.
  static Value custom(OptionType type, std::string range,
                      std::function<void(Target&, const std::string&)> set,
                      std::function<std::string(const Target&)> text) {
    return {type, std::move(range), {}, std::move(set), std::move(text)};
  }

  template <class Parent, class Struct>
  static Value flag(Parent parent, bool Struct::*field) {
    return custom(
        OptionType::flag, "",
        [=](Target& o, const std::string& text) {
          if (text != "true" && text != "false") refuseValue(text, "true or false");
          parent(o).*field = text == "true";
        },
        [=](const Target& o) -> std::string { return parent(o).*field ? "true" : "false"; });
  }

  template <class Parent, class Struct, class Whole>
  static Value whole(Parent parent, Whole Struct::*field, std::type_identity_t<Whole> low,
                     std::type_identity_t<Whole> high) {
    return custom(
        OptionType::whole, std::to_string(low) + ".." + std::to_string(high),
        [=](Target& o, const std::string& text) { parent(o).*field = wholeFrom(text, low, high); },
        [=](const Target& o) { return std::to_string(parent(o).*field); });
  }

  /// Only these whole numbers.
  template <class Parent, class Struct>
  static Value oneOf(Parent parent, int Struct::*field, const std::vector<int>& numbers) {
    const std::vector<std::string> choices = textsOf(numbers);
    return {OptionType::whole, "", choices,
            [=](Target& o, const std::string& text) {
              parent(o).*field = numbers[indexOf(text, choices)];
            },
            [=](const Target& o) { return std::to_string(parent(o).*field); }};
  }

  template <class Parent, class Struct>
  static Value number(Parent parent, double Struct::*field, NumberRange range) {
    return custom(
        OptionType::number, range.text,
        [=](Target& o, const std::string& text) {
          const std::optional<double> value = numberIn(text);
          const bool isIn = value && *value >= range.low && *value <= range.high &&
                            !(range.isAbove && *value == range.low);
          if (!isIn) {
            refuseValue(text, range.isAbove ? "a number above 0" : "a number in " + range.text);
          }
          parent(o).*field = *value;
        },
        [=](const Target& o) { return shortestText(parent(o).*field); });
  }

  /// A number in a range that includes its ends, or "auto" for another one.
  template <class Parent, class Struct>
  static Value numberOrAuto(Parent parent, double Struct::*field, double automatic,
                            NumberRange range) {
    return custom(
        OptionType::number, "auto|" + range.text,
        [=](Target& o, const std::string& text) {
          const std::optional<double> value = text == "auto" ? automatic : numberIn(text);
          const bool isIn = value && *value >= range.low && *value <= range.high;
          if (!isIn && text != "auto") refuseValue(text, "auto, or a number in " + range.text);
          parent(o).*field = *value;
        },
        [=](const Target& o) {
          const double value = parent(o).*field;
          return value == automatic ? "auto" : shortestText(value);
        });
  }

  /// Voxels in a range, or a percentage of the longest side.
  template <class Parent, class Struct>
  static Value length(Parent parent, Length Struct::*field, NumberRange range) {
    return custom(
        OptionType::length, range.text + "|P%",
        [=](Target& o, const std::string& text) {
          const std::optional<Length> value = lengthIn(text);
          if (!value || value->voxels < range.low || value->voxels > range.high) {
            refuseValue(text, "a number in " + range.text + ", or a percentage such as 0.8%");
          }
          parent(o).*field = *value;
        },
        [=](const Target& o) { return lengthText(parent(o).*field); });
  }

  /// The same of whole numbers of voxels, 0..most.
  template <class Parent, class Struct>
  static Value wholeLength(Parent parent, Length Struct::*field, int most) {
    return custom(
        OptionType::length, "0.." + std::to_string(most) + "|P%",
        [=](Target& o, const std::string& text) {
          parent(o).*field = text.ends_with('%') ? percentageFrom(text) : wholeFrom(text, 0, most);
        },
        [=](const Target& o) { return lengthText(parent(o).*field); });
  }

  /// Only these whole numbers of voxels, or a percentage.
  template <class Parent, class Struct>
  static Value lengthOf(Parent parent, Length Struct::*field, const std::vector<int>& numbers) {
    const std::vector<std::string> choices = textsOf(numbers);
    return {OptionType::length, "P%", choices,
            [=](Target& o, const std::string& text) {
              parent(o).*field = text.ends_with('%') ? percentageFrom(text)
                                                     : Length(numbers[indexOf(text, choices)]);
            },
            [=](const Target& o) { return lengthText(parent(o).*field); }};
  }

  /// One of names, in the order of the enum.
  template <class Parent, class Struct, class Enum>
  static Value choice(Parent parent, Enum Struct::*field, std::span<const char* const> names) {
    const std::vector<std::string> choices(names.begin(), names.end());
    return {OptionType::choice, "", choices,
            [=](Target& o, const std::string& text) {
              parent(o).*field = static_cast<Enum>(indexOf(text, choices));
            },
            [=](const Target& o) { return choices[static_cast<std::size_t>(parent(o).*field)]; }};
  }

  /// Some of names, separated by commas, each once.
  template <class Parent, class Struct, class Enum>
  static Value choices(Parent parent, std::vector<Enum> Struct::*field,
                       std::span<const char* const> names) {
    const std::vector<std::string> all(names.begin(), names.end());
    return {
        OptionType::choices, "", all,
        [=](Target& o, const std::string& text) {
          std::vector<Enum> found;
          for (const std::string& part : split(text)) {
            const auto at = std::find(all.begin(), all.end(), part);
            const auto value = static_cast<Enum>(at - all.begin());
            if (at == all.end() || std::find(found.begin(), found.end(), value) != found.end()) {
              refuseValue(text, "a list of " + joinedText(all, ", ") + ", each once");
            }
            found.push_back(value);
          }
          parent(o).*field = std::move(found);
        },
        [=](const Target& o) {
          std::vector<std::string> texts;
          for (const Enum value : parent(o).*field) {
            texts.push_back(all[static_cast<std::size_t>(value)]);
          }
          return joinedText(texts, ",");
        }};
  }

  template <class Parent, class Struct>
  static Value string(Parent parent, std::string Struct::*field, std::string range) {
    return custom(
        OptionType::text, std::move(range),
        [=](Target& o, const std::string& text) { parent(o).*field = text; },
        [=](const Target& o) { return parent(o).*field; });
  }
};

}  // namespace sherd
