//! What the files of effects would otherwise repeat word for word.

/// What every effect says of itself; `with` has further methods of [`Effect`](super::Effect).
macro_rules! describe {
    (
        $name:ident, $kind:literal, $model:ident in $domain:ident,
        needs [$($need:ident),*], confusers [$($confuser:literal),*] $(, lists [$($list:expr),*])?
        $(, with { $($method:tt)* })?
    ) => {
        impl $crate::effect::Effect for $name {
            fn kind(&self) -> &'static str {
                $kind
            }
            fn params(&self) -> &'static [$crate::effect::Param] {
                &PARAMS
            }
            $(
                fn list_params(&self) -> &'static [$crate::effect::Param] {
                    const LISTS: &[$crate::effect::Param] = &[$($list),*];
                    LISTS
                }
            )?
            fn needs(&self) -> &'static [$crate::effect::Column] {
                &[$($crate::effect::Column::$need),*]
            }
            fn domain(&self) -> $crate::effect::Domain {
                $crate::effect::Domain::$domain
            }
            fn confusers(&self) -> &'static [&'static str] {
                &[$($confuser),*]
            }
            fn model(&self) -> $crate::effect::Model {
                $crate::effect::Model::$model(&$name)
            }
            $($($method)*)?
        }
    };
}

/// A spectrum that is a stated coefficient set free.
macro_rules! frees {
    ($name:ident, $term:ident, $field:ident, course $course:literal) => {
        impl $crate::effect::Spectrum for $name {
            fn act(&self) -> $crate::effect::SpectrumAct {
                $crate::effect::SpectrumAct::Frees($crate::noise::data::NoiseType::$term)
            }
            fn density(&self, _fitted: &[f64], _bin: &$crate::effect::ModeBin) -> f64 {
                0.0
            }
            fn starts(&self, _look: &$crate::effect::SpectralContext<'_>) -> Vec<Vec<f64>> {
                vec![vec![]]
            }
            fn bounds(
                &self,
                _look: &$crate::effect::SpectralContext<'_>,
            ) -> Vec<$crate::numeric::range::Bounds> {
                vec![]
            }
            fn trials(&self, _look: &$crate::effect::SpectralContext<'_>) -> f64 {
                1.0
            }
            fn parameters(&self, fitted: &[f64]) -> Vec<f64> {
                fitted.to_vec()
            }
            fn stated(&self, values: &$crate::effect::Values) -> Option<Vec<f64>> {
                $crate::effect::number(values, PARAMS[0].name).map(|c| vec![c])
            }
            fn compose(&self, fitted: &[f64], _dt_s: f64, noise: &mut $crate::noise::composite::Composite) {
                if let [coefficient] = fitted {
                    noise.terms.$field = *coefficient;
                }
            }
            fn places(
                &self,
                fitted: &[f64],
                context: &$crate::effect::SpectralContext<'_>,
            ) -> Vec<$crate::effect::Place> {
                $crate::effect::shared::power_law::power_law_places(
                    $crate::noise::data::NoiseType::$term,
                    fitted,
                    context,
                )
            }
            fn has_course(&self) -> bool {
                $course
            }
        }
    };
}

/// A course that is one column times its only parameter: `column(drivers)`, where `applies(drivers)`.
macro_rules! linear {
    ($name:ident, replaces $nuisance:expr, places $places:ident) => {
        impl $crate::effect::MeanModel for $name {
            fn resolution(&self) -> $crate::effect::Resolution {
                $crate::effect::Resolution::FullRate
            }
            fn replaces(&self) -> Option<$crate::effect::Nuisance> {
                $nuisance
            }
            fn applies(&self, drivers: &Drivers) -> bool {
                applies(drivers)
            }
            fn starts(
                &self,
                _drivers: &Drivers,
                _look: &$crate::effect::SearchContext<'_>,
            ) -> $crate::effect::Starts {
                $crate::effect::Starts::linear()
            }
            fn bounds(&self, _drivers: &Drivers) -> Vec<$crate::numeric::range::Bounds> {
                vec![]
            }
            fn regressors(&self, _shape: &[f64], drivers: &Drivers) -> $crate::effect::Regressors {
                $crate::effect::Regressors {
                    columns: column(drivers).into_iter().collect(),
                    ..Default::default()
                }
            }
            fn parameters(&self, _shape: &[f64], coefficients: &[f64], _drivers: &Drivers) -> Vec<f64> {
                vec![coefficients.first().copied().unwrap_or(f64::NAN)]
            }
            fn course(&self, values: &$crate::effect::Values, drivers: &Drivers) -> Option<Vec<f64>> {
                let coefficient = $crate::effect::number(values, PARAMS[0].name)?;
                Some(column(drivers)?.into_iter().map(|x| coefficient * x).collect())
            }
            fn sizings(&self, _drivers: &Drivers) -> Vec<$crate::effect::Sizing> {
                vec![$crate::effect::Sizing::linear(&PARAMS[0])]
            }
            fn places(
                &self,
                _shape: &[f64],
                _coefficients: &[f64],
                drivers: &Drivers,
            ) -> Vec<$crate::effect::Place> {
                $places(drivers)
            }
        }
    };
}
