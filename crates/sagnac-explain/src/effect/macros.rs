//! Text that the files of effects would otherwise repeat word for word.

/// The description of an effect: what [`Effect`](super::Effect) asks of every one, and the properties in which it differs from a
/// plain one. Its parameters are `PARAMS`, unless `params` names others. `with` has further methods of the trait.
macro_rules! describe {
    (
        $name:ident, $kind:literal, $model:ident in $domain:ident,
        needs [$($need:ident),*], confusers [$($confuser:ident),*]
        $(, params $params:ident)?
        $(, lists [$($list:expr),*])?
        $(, texts [$($text:expr),*])?
        $(, properties [$($property:ident $($value:ident)?),*])?
        $(, with { $($method:tt)* })?
    ) => {
        impl $crate::effect::Effect for $name {
            fn kind(&self) -> &'static str {
                $kind
            }
            fn params(&self) -> &'static [$crate::effect::Param] {
                describe!(@ params $($params)?)
            }
            $(
                fn list_params(&self) -> &'static [$crate::effect::Param] {
                    const LISTS: &[$crate::effect::Param] = &[$($list),*];
                    LISTS
                }
            )?
            $(
                fn text_params(&self) -> &'static [&'static str] {
                    &[$($text),*]
                }
            )?
            fn needs(&self) -> &'static [$crate::effect::Column] {
                &[$($crate::effect::Column::$need),*]
            }
            fn domain(&self) -> $crate::effect::Domain {
                $crate::effect::Domain::$domain
            }
            fn confusers(&self) -> &'static [&'static dyn $crate::effect::Effect] {
                const CONFUSERS: &[&dyn $crate::effect::Effect] = &[$(&$crate::effect::kinds::$confuser),*];
                CONFUSERS
            }
            fn model(&self) -> $crate::effect::Model {
                $crate::effect::Model::$model(&$name)
            }
            $($(describe! { @ $property $($value)? })*)?
            $($($method)*)?
        }
    };
    (@ params) => {
        &PARAMS
    };
    (@ params $params:ident) => {
        &$params
    };
    (@ outside_format) => {
        fn in_format(&self) -> bool {
            false
        }
    };
    (@ reported_as $other:ident) => {
        fn reported_kind(&self) -> &'static str {
            $crate::effect::Effect::kind(&$crate::effect::kinds::$other)
        }
    };
    (@ slow) => {
        fn is_slow(&self) -> bool {
            true
        }
    };
    (@ family $family:ident) => {
        fn family(&self) -> Option<$crate::effect::Family> {
            Some($crate::effect::Family::$family)
        }
    };
    (@ law $law:ident) => {
        fn law(&self) -> Option<$crate::effect::ResponseLaw> {
            Some($crate::effect::ResponseLaw::$law)
        }
    };
    (@ carried_over) => {
        fn is_carried_over(&self) -> bool {
            true
        }
    };
    (@ short_events) => {
        fn is_short_events(&self) -> bool {
            true
        }
    };
    (@ free_form) => {
        fn is_free_form(&self) -> bool {
            true
        }
    };
    (@ follows_any_column) => {
        fn follows_any_column(&self) -> bool {
            true
        }
    };
    (@ if_few_cycles $other:ident) => {
        fn if_few_cycles(&self) -> Option<&'static dyn $crate::effect::Effect> {
            Some(&$crate::effect::kinds::$other)
        }
    };
    (@ reversed_pair $other:ident) => {
        fn reversed_pair(&self) -> Option<&'static dyn $crate::effect::Effect> {
            Some(&$crate::effect::kinds::$other)
        }
    };
}
