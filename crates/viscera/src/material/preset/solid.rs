//! Tissues that are the same in all directions, as far as was measured.

use super::{Evidence, KEEPS_VOLUME, Measured, TissuePreset};
use crate::material::LawKind;

const DENSITIES: &str = "ICRU Report 46 (1992); range: Kaye and Laby, Tables of Physical and Chemical Constants, 2.4.6, and the \
                         IT'IS tissue database 4.1 (2022)";

const fn density(value: f64, range: (f64, f64)) -> Measured {
    Measured {
        value,
        range,
        source: DENSITIES,
        species: "human",
        state: "healthy adults, tabulated",
        evidence: Evidence::Cited,
        weakness: None,
    }
}

pub(super) const LIVER: TissuePreset = TissuePreset {
    name: "liver",
    title: "Liver",
    law: LawKind::NeoHookean,
    young: Measured {
        value: 6.27e3,
        range: (5.04e3, 7.44e3),
        source: "Venkatesh, Wang, Teo, Ang, J. Magn. Reson. Imaging 39 (2014) 1: shear stiffness 2.09 ± 0.22 kPa, from 1.68 to \
                 2.48 kPa, 41 volunteers; E = 3 μ",
        species: "human",
        state: "in vivo, perfused, healthy; magnetic resonance elastography",
        evidence: Evidence::Read,
        weakness: None,
    },
    poisson: KEEPS_VOLUME,
    density: density(1060.0, (1050.0, 1079.0)),
    fibre: None,
};

pub(super) const KIDNEY: TissuePreset = TissuePreset {
    name: "kidney",
    title: "Kidney, parenchyma",
    law: LawKind::NeoHookean,
    young: Measured {
        value: 14.7e3,
        range: (13.2e3, 30.6e3),
        source: "Rouvière et al., J. Magn. Reson. Imaging 34 (2011) 880: shear modulus 4.9 ± 0.5 kPa at 45 Hz and \
                 9.4 ± 0.8 kPa at 76 Hz, 10 volunteers; E = 3 μ",
        species: "human",
        state: "in vivo, perfused, healthy; magnetic resonance elastography at 45 Hz",
        evidence: Evidence::Read,
        weakness: Some("twice as stiff at 76 Hz as at 45 Hz: at rest it is softer than either"),
    },
    poisson: KEEPS_VOLUME,
    density: density(1050.0, (1050.0, 1066.0)),
    fibre: None,
};

pub(super) const SPLEEN: TissuePreset = TissuePreset {
    name: "spleen",
    title: "Spleen",
    law: LawKind::NeoHookean,
    young: Measured {
        value: 10.7e3,
        range: (7.06e3, 16.7e3),
        source: "Mannelli et al., Am. J. Roentgenol. 195 (2010) 387: shear stiffness 3.565 ± 0.586 kPa driven from \
                 the right and 4.255 ± 0.625 kPa from the left, from 2.353 to 5.581 kPa, 16 volunteers; E = 3 μ",
        species: "human",
        state: "in vivo, perfused, healthy; magnetic resonance elastography at 60 Hz",
        evidence: Evidence::Read,
        weakness: Some("the same spleens came out 19 % stiffer when driven from the other side"),
    },
    poisson: KEEPS_VOLUME,
    density: density(1060.0, (1054.0, 1089.0)),
    fibre: None,
};

pub(super) const BRAIN: TissuePreset = TissuePreset {
    name: "brain",
    title: "Brain",
    law: LawKind::NeoHookean,
    young: Measured {
        value: 2.53e3,
        range: (2.01e3, 9.3e3),
        source: "Miller, Chinzei, J. Biomech. 35 (2002) 483: instantaneous shear modulus 842 Pa of an Ogden law of exponent −4.7; \
                 range: 670 Pa from the shift of human brains under gravity, J. R. Soc. Interface (2022), PMC9748497, and 3.1 kPa \
                 by elastography at 90 Hz, Green, Bilston, Sinkus, NMR Biomed. 21 (2008) 755; E = 3 μ",
        species: "pig; range: human",
        state: "ex vivo; tension, with a law that fits compression too; range: in vivo",
        evidence: Evidence::Cited,
        weakness: Some(
            "softer in tension than in compression, and relaxes to a fifth within minutes: no law here shows either",
        ),
    },
    poisson: KEEPS_VOLUME,
    density: density(1040.0, (1030.0, 1046.0)),
    fibre: None,
};

pub(super) const FAT: TissuePreset = TissuePreset {
    name: "fat",
    title: "Fat under the skin",
    law: LawKind::NeoHookean,
    young: Measured {
        value: 2.26e3,
        range: (2.26e3, 5.55e3),
        source: "Hatt, Lloyd, Bolsterlee, Bilston, J. Mech. Behav. Biomed. Mater. (2023) 105924: shear modulus 752 Pa, 10 women; \
                 range: breast-fat; E = 3 μ",
        species: "human",
        state: "in vivo, buttock, not compressed; magnetic resonance elastography at 50 Hz",
        evidence: Evidence::Cited,
        weakness: Some("stiffens fast when compressed: the modulus went with the power −1.18 of the stretch"),
    },
    poisson: KEEPS_VOLUME,
    density: density(950.0, (911.0, 950.0)),
    fibre: None,
};

const BREAST: &str =
    "Karakaş, Poçan, Medical Science Monitor 32 (2026) e952112: shear stiffness by elastography; E = 3 μ";

pub(super) const BREAST_FAT: TissuePreset = TissuePreset {
    name: "breast-fat",
    title: "Fat of the breast",
    law: LawKind::NeoHookean,
    young: Measured {
        value: 5.55e3,
        range: (1.87e3, 6.51e3),
        source: "Karakaş, Poçan, Medical Science Monitor 32 (2026) e952112: shear stiffness 1.85 ± 0.32 kPa; range: with 3.04 ± \
                 1.17 kPa for fat and gland together by suction, Clinical Biomechanics (2022), 7 volunteers; E = 3 μ",
        species: "human",
        state: "in vivo, healthy; magnetic resonance elastography",
        evidence: Evidence::Read,
        weakness: None,
    },
    poisson: KEEPS_VOLUME,
    density: density(950.0, (911.0, 950.0)),
    fibre: None,
};

pub(super) const BREAST_GLAND: TissuePreset = TissuePreset {
    name: "breast-gland",
    title: "Gland of the breast",
    law: LawKind::NeoHookean,
    young: Measured {
        value: 8.85e3,
        range: (7.56e3, 10.1e3),
        source: BREAST,
        species: "human",
        state: "in vivo, healthy; magnetic resonance elastography: 2.95 ± 0.43 kPa",
        evidence: Evidence::Read,
        weakness: None,
    },
    poisson: KEEPS_VOLUME,
    density: density(1020.0, (1020.0, 1041.0)),
    fibre: None,
};

const KERDOK: &str = "Kerdok, Cotin, Ottensmeyer, Galea, Howe, Dawson, Medical Image Analysis 7 (2003) 283";

pub(super) const TRUTH_CUBE: TissuePreset = TissuePreset {
    name: "truth-cube",
    title: "Silicone rubber of the truth cube",
    law: LawKind::NeoHookean,
    young: Measured {
        value: 14.9e3,
        range: (14.9e3, 14.9e3),
        source: KERDOK,
        species: "silicone rubber",
        state: "cured; compression",
        evidence: Evidence::Read,
        weakness: None,
    },
    poisson: Measured {
        value: 0.499,
        range: (0.499, 0.499),
        source: KERDOK,
        species: "silicone rubber",
        state: "taken there for the comparison",
        evidence: Evidence::Read,
        weakness: None,
    },
    density: Measured {
        value: 1000.0,
        range: (1000.0, 1000.0),
        source: KERDOK,
        species: "silicone rubber",
        state: "taken: the experiment is static, and hardly feels it",
        evidence: Evidence::Chosen,
        weakness: Some("not stated there"),
    },
    fibre: None,
};
