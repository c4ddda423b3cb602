//! Apache Parquet: columns of doubles, whole numbers and texts, each with the column's head as its
//! name; what is not known is null.

use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;

use super::cell::{Cell, Column, ColumnKind, TableError};
use crate::files::NewFile;

/// Rows that are kept in memory and written together.
const ROWS_OF_GROUP: usize = 65_536;

/// A file that is being written.
pub(super) struct ParquetFile {
    name: String,
    writer: SerializedFileWriter<NewFile>,
    columns: Vec<Values>,
    rows: usize,
}

/// A column's values in the present group, null where nothing is known.
enum Values {
    Numbers(Vec<Option<f64>>),
    Counts(Vec<Option<i64>>),
    Texts(Vec<Option<ByteArray>>),
}

impl ParquetFile {
    pub(super) fn new(name: &Path, file: NewFile, columns: &[Column]) -> Result<Self, TableError> {
        let name = name.display().to_string();
        let began = begin(file, columns);
        let writer = began.map_err(|source| TableError::Parquet { file: name.clone(), source })?;
        let columns = columns.iter().map(|column| Values::of(column.kind)).collect();
        Ok(Self { name, writer, columns, rows: 0 })
    }

    pub(super) fn row(&mut self, cells: &[Cell]) -> Result<(), TableError> {
        self.columns.iter_mut().zip(cells).for_each(|(column, cell)| column.push(cell));
        self.rows += 1;
        if self.rows == ROWS_OF_GROUP { self.write() } else { Ok(()) }
    }

    fn write(&mut self) -> Result<(), TableError> {
        let written = group(&mut self.writer, &mut self.columns);
        self.rows = 0;
        written.map_err(|source| TableError::Parquet { file: self.name.clone(), source })
    }

    pub(super) fn finish(mut self) -> Result<NewFile, TableError> {
        if self.rows > 0 {
            self.write()?;
        }
        let Self { name, writer, .. } = self;
        writer.into_inner().map_err(|source| TableError::Parquet { file: name, source })
    }
}

fn begin(file: NewFile, columns: &[Column]) -> Result<SerializedFileWriter<NewFile>, ParquetError> {
    let mut fields = Vec::with_capacity(columns.len());
    for column in columns {
        let (physical, logical) = match column.kind {
            ColumnKind::Number => (Physical::DOUBLE, None),
            ColumnKind::Count => (Physical::INT64, None),
            ColumnKind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        let field = Type::primitive_type_builder(&column.name, physical)
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(logical)
            .build()?;
        fields.push(Arc::new(field));
    }
    let schema = Type::group_type_builder("table").with_fields(fields).build()?;
    let compression = Compression::ZSTD(ZstdLevel::default());
    let properties = WriterProperties::builder().set_compression(compression).build();
    SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties))
}

fn group(
    writer: &mut SerializedFileWriter<NewFile>,
    columns: &mut [Values],
) -> Result<(), ParquetError> {
    let mut group = writer.next_row_group()?;
    for values in columns {
        if let Some(mut column) = group.next_column()? {
            values.write(&mut column)?;
            column.close()?;
        }
    }
    group.close()?;
    Ok(())
}

impl Values {
    fn of(kind: ColumnKind) -> Self {
        match kind {
            ColumnKind::Number => Self::Numbers(Vec::new()),
            ColumnKind::Count => Self::Counts(Vec::new()),
            ColumnKind::Text => Self::Texts(Vec::new()),
        }
    }

    fn push(&mut self, cell: &Cell) {
        match (self, cell) {
            (Self::Numbers(values), Cell::Number(value)) => values.push(Some(*value)),
            (Self::Counts(values), Cell::Count(count)) => values.push(i64::try_from(*count).ok()),
            (Self::Texts(values), Cell::Text(text)) => {
                values.push(Some(ByteArray::from(text.as_str())));
            }
            (Self::Numbers(values), _) => values.push(None),
            (Self::Counts(values), _) => values.push(None),
            (Self::Texts(values), _) => values.push(None),
        }
    }

    /// Writes all values into `column` and empties the list.
    fn write(&mut self, column: &mut SerializedColumnWriter<'_>) -> Result<(), ParquetError> {
        match self {
            Self::Numbers(values) => {
                let (known, levels) = known(values);
                column.typed::<DoubleType>().write_batch(&known, Some(&levels), None)?;
            }
            Self::Counts(values) => {
                let (known, levels) = known(values);
                column.typed::<Int64Type>().write_batch(&known, Some(&levels), None)?;
            }
            Self::Texts(values) => {
                let (known, levels) = known(values);
                column.typed::<ByteArrayType>().write_batch(&known, Some(&levels), None)?;
            }
        }
        Ok(())
    }
}

/// Values that are known, and for each place 1 where one is.
fn known<T>(values: &mut Vec<Option<T>>) -> (Vec<T>, Vec<i16>) {
    let levels = values.iter().map(|value| i16::from(value.is_some())).collect();
    (values.drain(..).flatten().collect(), levels)
}
