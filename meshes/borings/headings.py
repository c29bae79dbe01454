"""Lists common headings of tables of borings, in several languages, by the column names of this program."""

import re
import unicodedata
from collections.abc import Container, Sequence

# Headings as `compact` returns them. A heading that means one thing in one table and another one in the next (a water
# level is a depth or an elevation, a station a boring or a distance) is not among them.
HEADINGS: dict[str, tuple[str, ...]] = {
    "boring": (
        "borehole", "boreholeid", "boreholeno", "boreholename", "bore", "boreno", "boringno", "boringid", "boringname",
        "bh", "bhid", "bhno", "holeid", "hole", "holeno", "locaid", "pointid",
        "testhole", "bohrung", "bohrungnr", "bohrloch", "aufschluss", "sondage", "forage", "sondeo", "sondaggio",
        "孔番号", "孔名", "ボーリング名", "ボーリング番号", "ボーリングno", "調査孔", "地点名",
    ),
    "x": ("distance", "chainage", "距離", "測線距離", "追加距離", "stationierung"),
    "easting": ("east", "locanate", "rechtswert", "ostwert"),
    "northing": ("north", "locanatn", "hochwert", "nordwert"),
    "ground_level": (
        "groundelevation", "groundsurfaceelevation", "surfaceelevation", "surfacelevel", "collar",
        "collarelevation", "locagl", "toposurface", "gok", "ansatzhöhe", "ansatzpunkt", "geländehöhe",
        "geländeoberkante", "maaiveld", "maaiveldhoogte", "cotedusol", "cotetn", "cotasuperficie",
        "孔口標高", "地盤高", "地盤標高", "地表面標高",
    ),
    "top": (
        "from", "depthfrom", "fromdepth", "topdepth", "depthtop", "depthtotop", "start", "startdepth", "geoltop",
        "von", "oberkante", "ok", "vontiefe", "tiefevon", "van", "bovenkant", "desde", "de", "da",
        "上端深度", "上面深度", "上端", "深度上端", "層上面深度", "自",
    ),
    "bottom": (
        "to", "depthto", "todepth", "base", "depthbase", "basedepth", "bottomdepth", "depthbottom", "depthtobottom",
        "end", "enddepth", "geolbase", "bis", "unterkante", "uk", "bistiefe", "tiefebis", "tot", "onderkant", "hasta",
        "à", "a", "下端深度", "下面深度", "下端", "深度下端", "層下面深度", "至",
    ),
    "layer": (
        "stratum", "strata", "unit", "soil", "soiltype", "soilname", "material", "geology", "lithology", "geolgeol",
        "geologicalunit", "geologyunit", "layername", "schicht", "bodenart", "laag", "grondsoort", "couche",
        "estrato", "strato", "土質", "土質名", "土質区分", "地層", "地層名", "地質", "層名", "土層", "地層区分",
    ),
    "N": (
        "nvalue", "nspt", "sptn", "spt", "n30", "blows", "blowcount", "blowcounts", "sptnvalue", "sptblows", "nfield",
        "isptnval", "schlagzahl", "n値", "実測n値",
    ),
    "fines": (
        "finescontent", "fc", "finecontent", "finesfraction", "passing75um", "passing#200", "passing200", "p200",
        "feinkornanteil", "feinkorn", "feinanteil", "細粒分含有率", "細粒分", "細粒分含有率fc",
    ),
    "d50": ("meangrainsize", "mediangrainsize", "平均粒径", "平均粒径d50", "mittlererkorndurchmesser"),
    "plasticity": ("plasticityindex", "pi", "ip", "塑性指数", "塑性指数ip", "plastizitätszahl", "plastizität"),
    "unit_weight": (
        "gamma", "γ", "bulkunitweight", "unitwt", "totalunitweight", "wichte", "単位体積重量", "湿潤単位体積重量",
        "volumengewicht", "poidsvolumique",
    ),
    "water_level": (
        "watertableelevation", "groundwaterelevation", "waterelevation", "水位標高",
        "地下水位標高", "孔内水位標高",
    ),
    "water_depth": (
        "groundwaterdepth", "depthtowater", "depthtogroundwater", "watertabledepth", "gwdepth", "gwd", "水位深度",
        "地下水位深度", "孔内水位深度", "flurabstand",
    ),
    "energy_ratio": ("er", "hammerenergy", "hammerefficiency", "エネルギー比", "エネルギー効率"),
    "depth": ("testdepth", "depthbgl", "depthbelowground", "深度", "tiefe", "diepte", "profondeur", "profundidad"),
    "qc": (
        "coneresistance", "tipresistance", "conetipresistance", "spitzendruck", "spitzenwiderstand",
        "conusweerstand", "コーン貫入抵抗", "先端抵抗",
    ),
    "fs": (
        "sleevefriction", "sleeveresistance", "frictionresistance", "mantelreibung", "plaatselijkewrijving",
        "周面摩擦", "周面摩擦抵抗",
    ),
}  # fmt: skip

# Level to which elevations refer, or that depths are below, as written beside a unit of length: "mAHD", "ft NAVD88".
DATUM = (
    "ahd", "aod", "od", "odn", "nap", "taw", "nhn", "nn", "ünn", "ünhn", "asl", "amsl", "msl", "navd", "navd88", "ngvd",
    "ngvd29", "tp", "kp", "ap", "gl", "cd", "rl", "bgl", "bgs", "ebgl", "belowground", "belowgroundlevel",
    "abovesealevel",
)  # fmt: skip
LENGTH_UNITS = ("mm", "cm", "m", "ft")


def guessed_columns(headings: Sequence[str], known: Sequence[str], taken: Container[str]) -> dict[str, str]:
    """Return column names of this program by the headings that commonly stand for them.

    A name for which there are several such headings is not guessed.

    Parameters
    ----------
    headings : names of the columns in the file, without their units
    known : column names that the table may have
    taken : column names that need no guess
    """
    wanted = {word: name for name in known if name not in taken for word in HEADINGS.get(name, ())}
    met: dict[str, list[str]] = {}
    for heading in headings:
        if (name := wanted.get(compact(heading))) is not None:
            met.setdefault(name, []).append(heading)
    return {places[0]: name for name, places in met.items() if len(places) == 1}


def compact(heading: str) -> str:
    """Return a heading without capitals, blanks, points, hyphens, underscores and letters of full width."""
    return re.sub(r"[\s_.\-:/]+", "", unicodedata.normalize("NFKC", heading)).casefold()


def without_datum(unit: str) -> str:
    """Return a unit of length without the level to which an elevation or a depth refers: "m" of "mAHD", "m+NAP" or
    "T.P.m"; any other unit unchanged."""
    letters = re.sub(r"[^\w]|_", "", unicodedata.normalize("NFKC", unit)).casefold()
    for length in LENGTH_UNITS:
        if letters in {joined for datum in DATUM for joined in (length + datum, datum + length)}:
            return length
    return unit
