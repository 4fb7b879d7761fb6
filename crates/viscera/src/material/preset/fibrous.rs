//! Tissues with fibres. Their laws are quadratic, and tissue is not: it is soft until its collagen is straight, then ten to a
//! hundred times stiffer. The moduli here belong to the strain that is named with them.
//!
//! The fibres resist compression as they do tension, and buckle: pressed along them by a strain of more than about μ/2κ_a
//! the tissue gives way sideways, muscle and skin at 2 %. What is squeezed is better computed without them.

use super::{Evidence, FibrePreset, KEEPS_TRACE, Measured, TissuePreset};
use crate::material::LawKind;

const fn density(value: f64, range: (f64, f64), weakness: Option<&'static str>) -> Measured {
    Measured {
        value,
        range,
        source: "ICRU Report 46 (1992); range: Kaye and Laby, Tables of Physical and Chemical Constants, 2.4.6, and the IT'IS tissue \
                 database 4.1 (2022)",
        species: "human",
        state: "healthy adults, tabulated",
        evidence: Evidence::Cited,
        weakness,
    }
}

const AVERAGE_TISSUE: Option<&str> = Some("the average of soft tissue: that of the wall is not in the report");

pub(super) const MUSCLE: TissuePreset = TissuePreset {
    name: "muscle",
    title: "Skeletal muscle, passive",
    law: LawKind::StVenantKirchhoff,
    young: Measured {
        value: 22.4e3,
        range: (3.0e3, 37.1e3),
        source: "Morrow, Haut Donahue, Odegard, Kaufman, J. Mech. Behav. Biomed. Mater. 3 (2010) 124: 22.4 ± 14.7 kPa; range: shear \
                 modulus 1.0 kPa of the buttock in vivo, Hatt, Lloyd, Bolsterlee, Bilston, J. Mech. Behav. Biomed. Mater. (2023) \
                 105924, E = 3 μ",
        species: "rabbit; range: human",
        state: "ex vivo, tension across the fibres, steepest part of the curve; range: in vivo at 50 Hz",
        evidence: Evidence::Cited,
        weakness: Some(
            "studies disagree even on which direction is stiffer: Wheatley et al., J. Biomech. 49 (2016) 3056",
        ),
    },
    poisson: KEEPS_TRACE,
    density: density(1050.0, (1038.0, 1090.0), None),
    fibre: Some(FibrePreset {
        course: "along the muscle fibres",
        young: Measured {
            value: 447e3,
            range: (349e3, 545e3),
            source: "Morrow, Haut Donahue, Odegard, Kaufman, J. Mech. Behav. Biomed. Mater. 3 (2010) 124: 447 ± 98 kPa",
            species: "rabbit, extensor digitorum longus",
            state: "ex vivo, tension along the fibres, steepest part of the curve",
            evidence: Evidence::Cited,
            weakness: Some("the curve is flat before it is steep: a small stretch in the body meets far less"),
        },
    }),
};

pub(super) const SKIN: TissuePreset = TissuePreset {
    name: "skin",
    title: "Skin, epidermis and dermis together",
    law: LawKind::StVenantKirchhoff,
    young: Measured {
        value: 56.3e3,
        range: (39.9e3, 72.7e3),
        source: "in vivo stiffness of breast tissues by a light aspiration device, Clinical Biomechanics (2022): 56.3 ± 16.4 kPa, 7 \
                 volunteers; 40 kPa for the dermis of the forearm, Feng, Li, Ramier, Eltony, Yun, Acta Biomaterialia (2022) 295",
        species: "human",
        state: "in vivo; suction below 40 mbar",
        evidence: Evidence::Read,
        weakness: None,
    },
    poisson: KEEPS_TRACE,
    density: density(1090.0, (1090.0, 1190.0), None),
    fibre: Some(FibrePreset {
        course: "along Langer's lines",
        young: Measured {
            value: 1.18e6,
            range: (0.3e6, 2.06e6),
            source: "Ní Annaidh, Bruyère, Destrade, Gilchrist, Otténio, J. Mech. Behav. Biomed. Mater. 5 (2012) 139: initial slope 1.18 \
                     ± 0.88 MPa, 56 samples of the back",
            species: "human",
            state: "ex vivo, fresh or frozen; tension at 0.012 1/s, first part of the curve",
            evidence: Evidence::Read,
            weakness: Some(
                "the mean over all directions to Langer's lines, and in tension: suction in vivo meets a twentieth",
            ),
        },
    }),
};

pub(super) const GALLBLADDER_WALL: TissuePreset = TissuePreset {
    name: "gallbladder-wall",
    title: "Wall of the gallbladder",
    law: LawKind::StVenantKirchhoff,
    young: Measured {
        value: 255e3,
        range: (230e3, 280e3),
        source: "Karimi, Shojaei, Tehrani, J. Med. Eng. Technol. (2017), doi 10.1080/03091902.2017.1366561: 255 ± 25 kPa",
        species: "human",
        state: "ex vivo, cadaver; tension across the long axis",
        evidence: Evidence::Cited,
        weakness: Some(
            "one study, and the stiff part of its curves: Li et al., J. Mech. Behav. Biomed. Mater. 20 (2013) 363, find walls that \
             are soft at the pressures of the body",
        ),
    },
    poisson: KEEPS_TRACE,
    density: density(1030.0, (1030.0, 1071.0), AVERAGE_TISSUE),
    fibre: Some(FibrePreset {
        course: "along the long axis of the gallbladder",
        young: Measured {
            value: 641e3,
            range: (613e3, 669e3),
            source: "Karimi, Shojaei, Tehrani, J. Med. Eng. Technol. (2017), doi 10.1080/03091902.2017.1366561: 641 ± 28 kPa",
            species: "human",
            state: "ex vivo, cadaver; tension along the long axis",
            evidence: Evidence::Cited,
            weakness: Some("one study, and the stiff part of its curves"),
        },
    }),
};

pub(super) const ARTERY: TissuePreset = TissuePreset {
    name: "artery",
    title: "Wall of a large artery, at the pressure of the body",
    law: LawKind::StVenantKirchhoff,
    young: Measured {
        value: 386e3,
        range: (351e3, 702e3),
        source: "half of the modulus around the vessel: Lillie, Shadwick, Gosline, J. Biomech. 43 (2010) 2070 found elastic tissue of \
                 the aorta twice as stiff around as along, when inflated, and 1.4 times when not",
        species: "pig; modulus around the vessel: human",
        state: "ex vivo, purified elastic tissue, inflated",
        evidence: Evidence::Chosen,
        weakness: Some("a ratio of one tissue times a modulus of another"),
    },
    poisson: Measured {
        range: (0.3, 0.4999),
        source: "Fung, Biomechanics: Mechanical Properties of Living Tissues, Springer 1993; range: 0.3 to 0.4 in the plane of the wall \
                 and above 0.5 through it in porcine arteries, Skácel, Burša, J. Mech. Behav. Biomed. Mater. (2022)",
        ..KEEPS_TRACE
    },
    density: density(
        1050.0,
        (1030.0, 1102.0),
        Some("between the average of soft tissue and the vessel wall of the database"),
    ),
    fibre: Some(FibrePreset {
        course: "around the vessel",
        young: Measured {
            value: 771e3,
            range: (701e3, 983e3),
            source: "Riley, Barnes, Evans, Burke, Stroke 23 (1992) 952: common carotid artery, 701 kPa for women and 771 kPa for men of \
                     45 to 49 years, 983 kPa for men of 60 to 64; 3 321 people",
            species: "human",
            state: "in vivo, between diastolic and systolic pressure; ultrasound",
            evidence: Evidence::Read,
            weakness: Some(
                "measured about the stretch of the body, here taken from rest: a vessel without pressure is far softer",
            ),
        },
    }),
};
