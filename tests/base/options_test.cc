// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/options.h"

#include <cmath>

#include <gtest/gtest.h>

namespace pliant {
enum class Fruit { kApple, kPear };
template <>
struct EnumNames<Fruit> {
  static constexpr std::array kNames = {std::pair{Fruit::kApple, std::string_view("apple")},
                                        std::pair{Fruit::kPear, std::string_view("pear")}};
};
namespace {

struct BasketOptions {
  bool open = false;
  int count = 3;
  double weight = 0.1;
  std::string label = "a b";
  Fruit fruit = Fruit::kApple;
  std::vector<Fruit> others;
  void List(OptionTable& table) {
    table.BeginGroup("Basket", "what is carried");
    table.Add("open", &open, "-", "open at the top");
    table.Add("count", &count, "-", "how many", 1, 9);
    table.Add("weight", &weight, "kg", "of all", 0, 10);
    table.Add("label", &label, "-", "what it says");
    table.AddChoice("fruit", &fruit, "kind");
    table.AddChoices("others", &others, "kinds");
    table.Renamed("mass", "weight");
    table.Renamed("Bag.mark", "label");
    table.RenamedValue("fruit", "quince", "pear");
    table.RenamedValue("others", "quince", "pear");
    table.RenamedGroup("Hamper", "Basket");
  }
};

TEST(Options, EveryFieldPrintsWhatItReads) {
  BasketOptions options;
  OptionTable table;
  options.List(table);
  ASSERT_EQ(table.fields().size(), 6U);
  for (const OptionField& field : table.fields()) EXPECT_TRUE(field.set(field.get()).ok()) << field.name;
  EXPECT_TRUE(table.Set("Basket.fruit", "pear").ok());
  EXPECT_TRUE(table.Set("Basket.weight", "2.5").ok());
  EXPECT_EQ(options.fruit, Fruit::kPear);
  EXPECT_EQ(options.weight, 2.5);
}

TEST(Options, ARangeIsPrintedWithItsUnitWhereItHasOne) {
  double share = 0.5;
  for (const auto& [unit, text] :
       {std::pair{"px", "0.1 to 10 px"}, {"1", "0.1 to 10"}, {"-", "0.1 to 10"}, {"", "0.1 to 10"}}) {
    OptionTable table;
    table.BeginGroup("Cake", "to share");
    table.Add("share", &share, unit, "a part", 0.1, 10.0);
    EXPECT_EQ(table.Set("Cake.share", "0.01").message(),
              "Cake.share is '0.01'; give a number from " + std::string(text));
  }
}

TEST(Options, RefusesAndKeepsTheOldValue) {
  BasketOptions options;
  OptionTable table;
  options.List(table);
  for (const auto& [name, value] : {std::pair{"Basket.count", "0"},
                                    {"Basket.count", "3.5"},
                                    {"Basket.weight", "nan"},
                                    {"Basket.weight", "1kg"},
                                    {"Basket.open", "maybe"},
                                    {"Basket.fruit", "plum"}}) {
    const Status status = table.Set(name, value);
    EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument) << name;
    EXPECT_NE(status.message().find(name), std::string::npos);
  }
  EXPECT_EQ(options.count, 3);
  EXPECT_EQ(options.weight, 0.1);
}

TEST(Options, AnUnknownNameNamesItsNearestNeighbor) {
  BasketOptions options;
  OptionTable table;
  options.List(table);
  EXPECT_NE(table.Set("basket.wieght", "1").message().find("'Basket.weight'"), std::string::npos);
}

TEST(Options, AnEarlierNameIsRefusedWithTheNameOfToday) {
  BasketOptions options;
  OptionTable table;
  options.List(table);
  EXPECT_EQ(table.Set("Basket.mass", "1").message(), "Basket.mass is now called Basket.weight");
  EXPECT_EQ(table.Set("Bag.mark", "x").message(), "Bag.mark is now called Basket.label");
  EXPECT_EQ(table.Set("Hamper.count", "2").message(), "Hamper.count is now called Basket.count");
  EXPECT_EQ(table.Set("Hamper.mass", "2").message(), "Hamper.mass is now called Basket.weight");
  EXPECT_EQ(table.Set("Basket.fruit", "quince").message(), "the value 'quince' of Basket.fruit is now called 'pear'");
  EXPECT_EQ(table.Set("Basket.others", "apple,quince").message(),
            "the value 'quince' of Basket.others is now called 'pear'");
  EXPECT_EQ(table.Set("Basket.mass", "1").code(), ErrorCode::kInvalidArgument);
  EXPECT_NE(table.Set("Hamper.wieght", "1").message().find("there is no option"), std::string::npos);
  EXPECT_TRUE(table.Set("Basket.label", "quince").ok());
  for (const char* old_name : {"mass", "Hamper", "Bag"}) EXPECT_EQ(table.ToYaml().find(old_name), std::string::npos);
}

TEST(Options, DoublesReadBackExactly) {
  for (const double value : {0.1, 1e-300, -3.25, 1.0 / 3.0}) {
    double parsed = 0;
    EXPECT_TRUE(ParseDouble(FormatDouble(value), &parsed));
    EXPECT_EQ(parsed, value);
  }
}

TEST(Options, YamlHoldsEveryFieldUnderItsGroup) {
  BasketOptions options;
  OptionTable table;
  options.List(table);
  const std::string yaml = table.ToYaml();
  EXPECT_TRUE(yaml.starts_with("Basket:  # what is carried\n"));
  EXPECT_NE(yaml.find("\n  label: \"a b\""), std::string::npos);
}

}  // namespace
}  // namespace pliant
