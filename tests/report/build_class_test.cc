// SPDX-License-Identifier: MIT
/// Classes of sequences (docs/formulation.md 13.4) and what is said of places.
#include "fabseq/report/build_class.h"

#include "report/shared_places.h"

#include <gtest/gtest.h>

namespace fabseq {
namespace {

/// A place of one unit cube; a bead is two wide and one high, so that four of them are as large as one.
Place cube(PlaceForm form = PlaceForm::overhang, double x = 0.0) {
  Place place;
  place.form = form;
  place.elements = 1;
  place.volume = place.begins = 1.0;
  place.extent = {1.0, 1.0, 1.0};
  place.centre = {x + 0.5, 0.5, 0.5};
  place.lower = {x, 0.0, 0.0};
  place.upper = {x + 1.0, 1.0, 1.0};
  place.layer = 3;
  return place;
}

FaultyPlaces places_of(std::vector<Place> places, double part_volume = 1e4) {
  FaultyPlaces result;
  result.bead = {2.0, 1.0};
  result.part_volume = part_volume;
  result.in_all = static_cast<std::int64_t>(places.size());
  for (const Place& place : places) result.begins += place.begins;
  result.largest = std::move(places);
  return result;
}

const ToolSettings tool;

TEST(BuildClassTest, NoPlaceIsBuildable) { EXPECT_EQ(class_of(places_of({}), tool), BuildClass::buildable); }

TEST(BuildClassTest, FewPlacesSmallerThanABeadDoNotDecide) {
  EXPECT_EQ(class_of(places_of({cube()}), tool), BuildClass::buildable_but_for_places);
  EXPECT_EQ(class_of(places_of(std::vector<Place>(5, cube())), tool), BuildClass::buildable_but_for_places);
  EXPECT_EQ(class_of(places_of(std::vector<Place>(6, cube())), tool), BuildClass::not_buildable);
}

TEST(BuildClassTest, APlaceAsLargeAsABeadDecides) {
  Place wide = cube(), heavy = cube(), longish = cube();
  wide.extent = {2.0, 2.0, 1.0};
  EXPECT_EQ(class_of(places_of({wide}), tool), BuildClass::not_buildable);
  heavy.begins = 4.0;
  EXPECT_EQ(class_of(places_of({heavy}), tool), BuildClass::not_buildable);
  longish.extent = {3.0, 1.0, 1.0};
  longish.begins = longish.volume = 3.0;
  EXPECT_EQ(class_of(places_of({longish}), tool), BuildClass::buildable_but_for_places);
}

TEST(BuildClassTest, PlacesAreNoMoreThanAShareOfThePart) {
  EXPECT_EQ(class_of(places_of({cube()}, 200.0), tool), BuildClass::buildable_but_for_places);
  EXPECT_EQ(class_of(places_of({cube()}, 199.0), tool), BuildClass::not_buildable);
}

TEST(BuildClassTest, KeysSwitchTheClassOff) {
  ToolSettings strict;
  strict.most_places = 0;
  EXPECT_EQ(class_of(places_of({cube()}), strict), BuildClass::not_buildable);
  strict = {};
  strict.places_share = 0.0;
  EXPECT_EQ(class_of(places_of({cube()}), strict), BuildClass::not_buildable);
}

TEST(BuildClassTest, WordsNameSizePlaceAndCure) {
  EXPECT_EQ(words_of(BuildClass::buildable_but_for_places, 1), "buildable but for 1 place");
  EXPECT_EQ(words_of(BuildClass::not_buildable, 7), "not buildable");
  ModelSettings settings;
  settings.unit = "mm";
  Place roof = cube(PlaceForm::roof);
  EXPECT_EQ(words_of(roof, places_of({roof}), settings),
            "a roof of 1 x 1 x 1 mm near [0.5,0.5,0.5] begins in the air in layer 3: "
            "close it (stock; new --fill-holes) and drill");
  roof.begins = 100.0;
  EXPECT_EQ(
      words_of(roof, places_of({roof}), settings),
      "a roof of 1 x 1 x 1 mm near [0.5,0.5,0.5] begins in the air in layer 3, with 1 % of the part on it: "
      "close it (stock; new --fill-holes) and drill");
}

SequenceNumbers sequence_with(const FaultyPlaces& places) {
  SequenceNumbers result;
  result.found.places = places;
  return result;
}

TEST(SharedPlacesTest, RoofsOfAllSequencesDoNotDecide) {
  Place roof = cube(PlaceForm::roof), elsewhere = cube(PlaceForm::roof, 8.0),
        island = cube(PlaceForm::island);
  for (Place* place : {&roof, &elsewhere, &island}) place->begins = 50.0;
  const SequenceNumbers with_roof = sequence_with(places_of({roof})),
                        beside_it = sequence_with(places_of({cube(PlaceForm::roof, 2.5)})),
                        far_away = sequence_with(places_of({elsewhere})),
                        with_island = sequence_with(places_of({island}));
  EXPECT_EQ(class_beside(with_roof, {&with_roof, &beside_it}, tool), BuildClass::buildable);
  EXPECT_EQ(class_beside(with_roof, {&with_roof, &far_away}, tool), BuildClass::not_buildable);
  EXPECT_EQ(class_beside(with_roof, {&with_roof}, tool), BuildClass::not_buildable)
      << "nothing to compare with";
  EXPECT_EQ(class_beside(with_island, {&with_island, &with_island}, tool), BuildClass::not_buildable);
}

}  // namespace
}  // namespace fabseq
